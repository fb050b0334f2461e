#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "frame_statistics.hpp"
#include "image_subscription.hpp"
#include "lazy_subscriber.hpp"
#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// The images of the topic `image`, to which it subscribes only while the node's results are wanted, or always if
/// ~always_subscribe is set. A frame that cannot be used is refused, logged and counted.
class LazyImageInput
{
public:
  /// Processes a frame, whose pixels `image` views; it may throw std::exception to refuse it.
  using Process = std::function<void(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image)>;

  /// Reads the parameters. No frame comes before start(). `on_listen` is told when it subscribes, and when it ends
  /// that.
  LazyImageInput(
      const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name, Process process,
      std::function<bool()> is_wanted, std::function<void(bool)> on_listen = [](bool /*listens*/) {});
  ~LazyImageInput();

  FrameStatistics& statistics() { return diagnostics_.statistics(); }

  void start();
  /// As LazySubscriber's. Thread-safe; to be called when the results' subscribers come or go.
  void update() { subscriber_.update(); }

private:
  void listen(bool wanted);
  void onImage(const sensor_msgs::ImageConstPtr& message);

  ros::NodeHandle nh_;
  std::string name_;
  Process process_;
  std::function<void(bool)> on_listen_;
  FrameDiagnostics diagnostics_;
  Throttle throttle_;
  image_transport::ImageTransport it_;
  const image_transport::TransportHints hints_;
  ImageSubscription subscription_;
  LazySubscriber subscriber_;  // calls listen()
};

}  // namespace robot_vision
