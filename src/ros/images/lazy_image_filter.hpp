#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <functional>
#include <mutex>
#include <string>

#include "frame_statistics.hpp"
#include "image_message.hpp"
#include "image_subscription.hpp"
#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// Filters each image of the topic `image` and publishes the result on ~processed_image with the same header. It
/// subscribes only while ~processed_image has subscribers, or always if ~always_subscribe is set. A frame that cannot
/// be used is refused, logged and counted.
class LazyImageFilter
{
public:
  /// The processing of the pixels; both functions may throw std::exception to refuse a frame.
  struct Step
  {
    /// The encoding of the output of apply() for an input of this encoding.
    std::function<std::string(const std::string& encoding)> output_encoding;
    /// Writes the result into `out`, which has the input's size and the output encoding's type.
    std::function<void(const cv::Mat& image, const std::string& encoding, cv::Mat& out)> apply;
  };

  LazyImageFilter(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name, Step step);
  ~LazyImageFilter();

private:
  void updateSubscription();
  void onImage(const sensor_msgs::ImageConstPtr& message);
  sensor_msgs::ImagePtr process(const sensor_msgs::Image& message);

  ros::NodeHandle nh_;
  ros::NodeHandle pnh_;
  std::string name_;
  Step step_;
  bool always_subscribe_ = false;
  FrameDiagnostics diagnostics_;
  Throttle throttle_;
  ImagePool pool_;
  std::mutex mutex_;  // guards all below, as connections come also during the setup and the destruction
  bool stopping_ = false;
  image_transport::ImageTransport it_;
  image_transport::ImageTransport private_it_;
  image_transport::Publisher publisher_;
  ImageSubscription subscription_;
};

}  // namespace robot_vision
