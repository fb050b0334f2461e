#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <array>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "robot_vision/common/throttle.hpp"
#include "ros/images/frame_statistics.hpp"
#include "ros/images/image_subscription.hpp"
#include "ros/images/lazy_subscriber.hpp"
#include "stereo_pairs.hpp"

namespace robot_vision
{

/// Two images that belong together.
struct StereoFrame
{
  StereoPair messages;
  std::array<cv::Mat, 2> images;  // the pixels of the messages, not to be written
  StereoTopics topics;            // where they came from
};

/// The images and camera_info of two cameras, on left/image_raw, left/camera_info, right/image_raw and
/// right/camera_info, to which it subscribes only while the node's results are wanted, or always if ~always_subscribe
/// is set. camera_info is expected beside the images, if these are remapped and it is not. What belongs together is
/// found by StereoPairs, with ~slop. A pair that cannot be used is refused, logged and counted; so is each left image
/// while no pairs come.
class StereoInput
{
public:
  /// Processes a pair; it may throw std::exception to refuse it.
  using Process = std::function<void(const StereoFrame& frame)>;

  /// As LazyImageInput's.
  StereoInput(
      const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name, Process process,
      std::function<bool()> is_wanted, std::function<void(bool)> on_listen = [](bool /*listens*/) {});
  ~StereoInput();

  FrameStatistics& statistics() { return diagnostics_.statistics(); }

  void start();
  /// Subscribes or not, as the results are wanted now. Thread-safe; to be called when their subscribers come or go.
  void update() { subscriber_.update(); }

private:
  void listen(bool wanted);
  void subscribe();
  void unsubscribe();
  void onImage(std::size_t side, const sensor_msgs::ImageConstPtr& message);
  void onInfo(std::size_t side, const sensor_msgs::CameraInfoConstPtr& message);
  void process(const StereoPair& pair);
  void refuse(const std::string& what);

  ros::NodeHandle nh_;
  std::string name_;
  Process process_;
  std::function<void(bool)> on_listen_;
  FrameDiagnostics diagnostics_;
  Throttle throttle_;
  image_transport::ImageTransport it_;
  const image_transport::TransportHints hints_;
  StereoTopics topics_;
  StereoPairs pairs_;
  std::array<ImageSubscription, 2> images_;
  std::array<ros::Subscriber, 2> infos_;
  LazySubscriber subscriber_;  // calls listen()
};

}  // namespace robot_vision
