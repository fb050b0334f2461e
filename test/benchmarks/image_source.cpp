// Publishes images over all transports, each a copy of the same one: ~width and ~height (px), ~rate (Hz; 0: none).

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <opencv2/core.hpp>

#include "ros/images/pooled_image_publisher.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "image_source");
  ros::NodeHandle nh;
  const ros::NodeHandle pnh("~");
  cv::Mat pixels(pnh.param("height", 480), pnh.param("width", 640), CV_8UC3);
  cv::randu(pixels, 0, 256);
  robot_vision::CallbackGate gate;
  gate.guard(nh);
  image_transport::ImageTransport it(nh);
  robot_vision::PooledImagePublisher publisher(
      nh.resolveName("image"), it, [] {}, gate.between());
  ros::AsyncSpinner spinner(1);
  spinner.start();
  const double rate = pnh.param("rate", 30.0);
  if (rate <= 0.0) ros::waitForShutdown();
  std_msgs::Header header;
  for (ros::WallRate pace(rate <= 0.0 ? 1.0 : rate); ros::ok(); pace.sleep())
  {
    ++header.seq;
    header.stamp = ros::Time::now();
    publisher.publish(pixels, "bgr8", header);
  }
  return 0;
}
