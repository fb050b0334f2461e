#pragma once

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <algorithm>
#include <string>

#include "moving_messages.hpp"
#include "ros/camera/scene_messages.hpp"

namespace bench
{

/// Publishes what a Kinect would beside a color camera: depths of 640x480 of a wall, a floor and a box that wanders,
/// the calibration and, once, where the camera is.
class DepthSource
{
public:
  /// `topic` is that of the images, "/camera/depth/image_raw".
  DepthSource(ros::NodeHandle nh, const std::string& topic, const std::string& color_frame)
    : images_(nh.advertise<sensor_msgs::Image>(topic, 1)),
      infos_(nh.advertise<sensor_msgs::CameraInfo>(image_transport::getCameraInfoTopic(topic), 1)),
      info_(robot_vision::toCameraInfo(
          {kWidth, kHeight, {kF, 0.0, 320.0, 0.0, kF, 240.0, 0.0, 0.0, 1.0}, std::vector<double>(5)}))
  {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = color_frame;
    transform.child_frame_id = kFrame;
    transform.transform.translation.x = -0.025;
    transform.transform.rotation.w = 1.0;
    transforms_.sendTransform(transform);
    for (int i = 0; i < kImages; ++i)
    {
      std_msgs::Header header;
      header.frame_id = kFrame;
      messages_.push_back(cv_bridge::CvImage(header, sensor_msgs::image_encodings::TYPE_16UC1, depths(i)).toImageMsg());
    }
  }

  bool connected() const { return images_.getNumSubscribers() > 0; }

  void publish(int number, const ros::Time& stamp)
  {
    const sensor_msgs::ImagePtr& message = messages_[static_cast<std::size_t>(number % kImages)];
    message->header.stamp = stamp;
    info_.header = message->header;
    infos_.publish(info_);
    images_.publish(message);
  }

private:
  static constexpr int kWidth = 640, kHeight = 480, kImages = 8;
  static constexpr double kF = 525.0;  // px
  static constexpr char kFrame[] = "depth_camera";

  static cv::Mat depths(int number)
  {
    cv::Mat depth(kHeight, kWidth, CV_16UC1);
    for (int y = 0; y < kHeight; ++y)
      depth.row(y).setTo(cv::Scalar(std::min(3500.0, 600.0 * kF / std::max(1.0, y - 0.5 * kHeight))));
    cv::rectangle(depth, cv::Rect(200 + 10 * number, 150, 160, 160), cv::Scalar(1200), cv::FILLED);
    return depth;
  }

  ros::Publisher images_, infos_;
  sensor_msgs::CameraInfo info_;
  tf2_ros::StaticTransformBroadcaster transforms_;
  std::vector<sensor_msgs::ImagePtr> messages_;
};

}  // namespace bench
