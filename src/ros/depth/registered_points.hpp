#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>

#include "cloud_pool.hpp"
#include "color_pairs.hpp"
#include "registration_input.hpp"
#include "robot_vision/common/throttle.hpp"
#include "robot_vision/depth/depth_points.hpp"
#include "ros/images/frame_statistics.hpp"
#include "ros/images/image_subscription.hpp"

namespace robot_vision
{

/// Makes clouds of registered depth images, with or without the colors of rgb/image_raw. A color image that cannot be
/// used is refused, logged and counted; so is that none comes at the time of the depth images.
class RegisteredPoints
{
public:
  using Publish = std::function<void(const sensor_msgs::PointCloud2Ptr& cloud)>;

  /// Reads ~slop and ~image_transport. Throws std::invalid_argument if one of them is out of range.
  RegisteredPoints(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, RegistrationTopics topics);

  /// What is to be done with a cloud; to be called before the first one is made.
  void setPublish(Publish publish) { publish_ = std::move(publish); }

  /// Subscribes to the color images, or ends that.
  void listen(bool listens);
  bool listens() const { return static_cast<bool>(subscription_); }

  /// Publishes the points of a registered depth image, which must not change any more: at once without colors, else
  /// when its color image is there. `maker` is of the camera of its pixels. Returns whether they were published at
  /// once; if not, `statistics` are told what becomes of them, with `counts` also that they were published.
  bool add(const sensor_msgs::ImageConstPtr& depth, const std::shared_ptr<const DepthPoints>& maker,
           FrameStatistics& statistics, bool counts);

private:
  void onColor(const sensor_msgs::ImageConstPtr& message);
  bool publish(const std::optional<ColoredDepth>& pair);
  void publishColored(const ColoredDepth& pair);
  void tell(const std::string& what);

  ros::NodeHandle nh_;
  ros::NodeHandle pnh_;
  image_transport::ImageTransport it_;
  const image_transport::TransportHints hints_;
  RegistrationTopics topics_;
  Publish publish_;
  Throttle throttle_;
  CloudPool pool_;
  std::shared_ptr<const DepthPoints> maker_;  // these three are of the last depth image
  FrameStatistics* statistics_ = nullptr;
  bool counts_ = false;
  cv::Mat converted_;  // memory for the next color image that is not bgr8
  ColorPairs pairs_;
  ImageSubscription subscription_;
};

}  // namespace robot_vision
