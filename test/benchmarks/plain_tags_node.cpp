// An AprilTag node as people use it, to compare with: image and camera_info -> ~tags and /tf. It does what apriltag_ros
// does with its own defaults: each frame in full resolution, 2 threads, the pose by cv::solvePnP.

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <cv_bridge/cv_bridge.h>
#include <image_transport/image_transport.h>
#include <robot_vision/TagDetectionArray.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <opencv2/calib3d.hpp>

namespace
{

constexpr double kSize = 0.1;  // m

geometry_msgs::Pose toPose(const cv::Mat& turn, const cv::Mat& place)
{
  const double angle = cv::norm(turn);
  const double part = angle > 0.0 ? std::sin(angle / 2.0) / angle : 0.5;
  geometry_msgs::Pose pose;
  pose.position.x = place.at<double>(0);
  pose.position.y = place.at<double>(1);
  pose.position.z = place.at<double>(2);
  pose.orientation.x = turn.at<double>(0) * part;
  pose.orientation.y = turn.at<double>(1) * part;
  pose.orientation.z = turn.at<double>(2) * part;
  pose.orientation.w = std::cos(angle / 2.0);
  return pose;
}

class PlainTags
{
public:
  PlainTags() : it_(ros::NodeHandle())
  {
    detector_->nthreads = 2;
    detector_->quad_decimate = 1.0F;
    apriltag_detector_add_family(detector_.get(), family_.get());
    publisher_ = ros::NodeHandle("~").advertise<robot_vision::TagDetectionArray>("tags", 1);
    subscriber_ = it_.subscribeCamera("image", 1, &PlainTags::onImage, this);
  }

private:
  void onImage(const sensor_msgs::ImageConstPtr& message, const sensor_msgs::CameraInfoConstPtr& info)
  {
    const cv::Mat gray = cv_bridge::toCvShare(message, "mono8")->image;
    image_u8_t image = {gray.cols, gray.rows, static_cast<int>(gray.step), gray.data};
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(apriltag_detector_detect(detector_.get(), &image),
                                                               apriltag_detections_destroy);
    robot_vision::TagDetectionArray tags;
    tags.header = message->header;
    for (int i = 0; i < zarray_size(found.get()); ++i)
    {
      apriltag_detection_t* tag = nullptr;
      zarray_get(found.get(), i, &tag);
      tags.detections.push_back(located(*tag, *info));
      broadcast(message->header, tags.detections.back());
    }
    publisher_.publish(tags);
  }

  static robot_vision::TagDetection located(const apriltag_detection_t& tag, const sensor_msgs::CameraInfo& info)
  {
    constexpr double half = kSize / 2.0;
    const std::vector<cv::Point3d> body = {
        {-half, -half, 0.0}, {half, -half, 0.0}, {half, half, 0.0}, {-half, half, 0.0}};
    std::vector<cv::Point2d> corners;
    for (const auto& corner : tag.p)
      corners.emplace_back(corner[0], corner[1]);
    cv::Mat turn;
    cv::Mat place;
    cv::solvePnP(body, corners, cv::Matx33d(info.K.data()), info.D, turn, place);
    robot_vision::TagDetection detection;
    detection.id = tag.id;
    detection.has_pose = true;
    detection.pose.pose = toPose(turn, place);
    return detection;
  }

  void broadcast(const std_msgs::Header& header, const robot_vision::TagDetection& tag)
  {
    geometry_msgs::TransformStamped transform;
    transform.header = header;
    transform.child_frame_id = "tag_" + std::to_string(tag.id);
    transform.transform.translation.x = tag.pose.pose.position.x;
    transform.transform.translation.y = tag.pose.pose.position.y;
    transform.transform.translation.z = tag.pose.pose.position.z;
    transform.transform.rotation = tag.pose.pose.orientation;
    tf_.sendTransform(transform);
  }

  std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family_{tag36h11_create(), tag36h11_destroy};
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_{apriltag_detector_create(),
                                                                                 apriltag_detector_destroy};
  image_transport::ImageTransport it_;
  ros::Publisher publisher_;
  image_transport::CameraSubscriber subscriber_;
  tf2_ros::TransformBroadcaster tf_;
};

}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "plain_tags");
  PlainTags node;
  ros::spin();
  return 0;
}
