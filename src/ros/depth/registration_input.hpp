#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <cstddef>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/throttle.hpp"
#include "ros/images/frame_statistics.hpp"
#include "ros/images/image_subscription.hpp"
#include "ros/images/lazy_subscriber.hpp"

namespace robot_vision
{

/// Where the images and calibrations of a depth camera and a color camera come from.
struct RegistrationTopics
{
  explicit RegistrationTopics(const ros::NodeHandle& nh);

  std::string depth_image, depth_info, color_image, color_info;
};

/// A depth image and the newest calibrations, those of the pixels of images.
struct RegistrationFrame
{
  sensor_msgs::ImageConstPtr depth;
  cv::Mat image;  // the pixels of `depth`, not to be written
  sensor_msgs::CameraInfoConstPtr depth_info;
  sensor_msgs::CameraInfoConstPtr color_info;
  FrameStatistics* statistics;  // of the input, for what is published or refused later
};

/// The depth images on depth/image_raw, over ~depth_image_transport, and the calibrations on depth/camera_info and
/// rgb/camera_info, to which it subscribes only while the node's results are wanted, or always if ~always_subscribe is
/// set. A camera_info that is not remapped is expected beside its image. If that of the color camera has a binning or a
/// region, the size of an image on rgb/image_raw, over ~image_transport, tells whether it is that of the images; if
/// none comes, it is taken for that of the whole sensor. A depth image that cannot be used is refused, logged and
/// counted; so is that no calibration comes.
class RegistrationInput
{
public:
  static constexpr std::size_t kMaxWaiting = 20;  // depth images in a row that lack something, until none waits

  /// Processes a frame. Returns whether anything was published; it may throw std::exception to refuse it.
  using Process = std::function<bool(const RegistrationFrame& frame)>;

  /// As LazyImageInput's.
  RegistrationInput(
      const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name, Process process,
      std::function<bool()> is_wanted, std::function<void(bool)> on_listen = [](bool /*listens*/) {});
  ~RegistrationInput();

  FrameStatistics& statistics() { return diagnostics_.statistics(); }

  void start();
  /// Subscribes or not, as the results are wanted now. Thread-safe; to be called when their subscribers come or go.
  void update() { subscriber_.update(); }

private:
  void listen(bool wanted);
  void subscribe();
  void unsubscribe();
  void onDepth(const sensor_msgs::ImageConstPtr& message);
  bool waits();
  void forgetOtherSize();
  bool needsColorSize() const;
  void lookForColorSize();
  bool process(const sensor_msgs::ImageConstPtr& message);

  ros::NodeHandle nh_;
  std::string name_;
  Process process_;
  std::function<void(bool)> on_listen_;
  FrameDiagnostics diagnostics_;
  Throttle throttle_;
  image_transport::ImageTransport it_;
  const image_transport::TransportHints hints_;
  const image_transport::TransportHints color_hints_;
  RegistrationTopics topics_;
  std::size_t waiting_ = 0;  // depth images in a row that lack something
  sensor_msgs::CameraInfoConstPtr depth_info_;
  sensor_msgs::CameraInfoConstPtr color_info_;
  cv::Size color_size_;                         // of the color images; empty until it is asked for and known
  sensor_msgs::CameraInfoConstPtr sized_info_;  // that had this size
  ImageSubscription depth_subscription_;
  ImageSubscription color_subscription_;  // while that size is looked for
  ros::Subscriber depth_info_subscription_;
  ros::Subscriber color_info_subscription_;
  LazySubscriber subscriber_;  // calls listen()
};

}  // namespace robot_vision
