#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "core/common/throttle.hpp"
#include "frame_statistics.hpp"
#include "image_message.hpp"
#include "image_subscription.hpp"

namespace robot_vision
{

/// Makes each picture of `image` into one on ~processed_image, and subscribes only while somebody looks (always, if
/// ~always_subscribe). The header is kept. A frame that cannot be used is refused, logged and counted.
class LazyImageFilter
{
public:
  /// What is done to the pixels; both may throw std::exception to refuse a frame.
  struct Step
  {
    /// The encoding of what apply() writes for input of this encoding.
    std::function<std::string(const std::string& encoding)> output_encoding;
    /// Writes into `out`, which has the input's size and the output encoding's type.
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
  std::mutex mutex_;  // guards all below: connections come while they are being set up, and while the nodelet ends
  bool stopping_ = false;
  image_transport::ImageTransport it_;
  image_transport::ImageTransport private_it_;
  image_transport::Publisher publisher_;
  ImageSubscription subscription_;
};

}  // namespace robot_vision
