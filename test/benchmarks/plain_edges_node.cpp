// An edge detector as people write it, to compare with: image -> ~edges.

#include <cv_bridge/cv_bridge.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/image_encodings.h>

#include <opencv2/imgproc.hpp>

class PlainEdges
{
public:
  PlainEdges() : nh_("~"), it_(ros::NodeHandle()), private_it_(nh_)
  {
    publisher_ = private_it_.advertise("edges", 1);
    subscriber_ = it_.subscribe("image", 1, &PlainEdges::onImage, this);
  }

private:
  void onImage(const sensor_msgs::ImageConstPtr& message)
  {
    const cv_bridge::CvImagePtr image = cv_bridge::toCvCopy(message, sensor_msgs::image_encodings::BGR8);
    cv::Mat gray;
    cv::Mat blurred;
    cv::Mat edges;
    cv::cvtColor(image->image, gray, cv::COLOR_BGR2GRAY);
    cv::blur(gray, blurred, cv::Size(7, 7));
    cv::Canny(blurred, edges, 15.0, 30.0);
    publisher_.publish(cv_bridge::CvImage(message->header, sensor_msgs::image_encodings::MONO8, edges).toImageMsg());
  }

  ros::NodeHandle nh_;
  image_transport::ImageTransport it_;
  image_transport::ImageTransport private_it_;
  image_transport::Publisher publisher_;
  image_transport::Subscriber subscriber_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "plain_edges");
  PlainEdges node;
  ros::spin();
  return 0;
}
