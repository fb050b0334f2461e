#pragma once

#include <image_transport/image_transport.h>
#include <sensor_msgs/CameraInfo.h>

#include <deque>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "frame_statistics.hpp"
#include "image_subscription.hpp"
#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// A received image.
struct ReceivedImage
{
  sensor_msgs::ImageConstPtr message;  // owns the pixels; null if they were converted to memory of their own
  std_msgs::Header header;
  cv::Mat pixels;        // not to be written, because other subscribers in the process may share them
  std::string encoding;  // of the pixels
  sensor_msgs::CameraInfoConstPtr camera_info;  // with the same stamp, if it is wanted
};

/// Receives the newest image of a topic over any image_transport. Messages are only stored when they arrive; take()
/// converts, refuses and counts them, so that images that nobody takes cost nothing. Only one thread may call take();
/// the rest is thread-safe.
class LatestImageSubscriber
{
public:
  struct Params
  {
    std::string topic;              // absolute; it is not remapped any more
    std::string transport = "raw";  // raw, compressed, ...; the parameter image_transport does not override it
    std::string parameters = "~";   // namespace of the transport's own parameters
    std::string encoding;           // encoding to convert to; "" for no conversion
    std::string camera_info_topic;  // absolute topic of the camera_info to pair with each image; "" for none
  };

  /// `nh` and `it` must use the queue through which the messages are to come; once `it` is destroyed, the subscriber
  /// stays closed. Throws std::invalid_argument if the encoding is unknown, or if the transport is not installed,
  /// naming the installed ones.
  LatestImageSubscriber(const Params& params, const ros::NodeHandle& nh,
                        const std::shared_ptr<image_transport::ImageTransport>& it,
                        std::shared_ptr<FrameStatistics> statistics);
  ~LatestImageSubscriber() { close(); }
  LatestImageSubscriber(const LatestImageSubscriber&) = delete;
  LatestImageSubscriber& operator=(const LatestImageSubscriber&) = delete;

  void open();   // subscribes; if the master does not answer, it waits until roscpp is shut down
  void close();  // unsubscribes and drops images that were not taken yet
  std::uint32_t publishers() const;

  /// The newest image since the last call, empty if there is none. An image that cannot be used is refused.
  std::optional<ReceivedImage> take();
  /// The image that was taken last has been processed, and its results are published.
  void finished();
  /// The processing of that image has failed, and the caller has logged it; the image counts as refused.
  void failed(const std::string& reason);

  FrameStatistics::Totals totals() const { return statistics_->totals(); }

private:
  void refuse(const sensor_msgs::Image& message, const std::string& reason);
  void onImage(const sensor_msgs::ImageConstPtr& message);
  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info);
  std::optional<ReceivedImage> takeNewest();
  sensor_msgs::CameraInfoConstPtr infoOf(const sensor_msgs::Image& image) const;

  Params params_;
  ros::NodeHandle nh_;
  std::weak_ptr<image_transport::ImageTransport> it_;
  std::shared_ptr<FrameStatistics> statistics_;
  Throttle throttle_;
  ros::Time taken_stamp_;
  FrameStatistics::Clock::time_point taken_at_;

  mutable std::mutex mutex_;  // guards all below
  bool open_ = false;
  ImageSubscription subscription_;
  ros::Subscriber info_subscriber_;
  // The newest image; with camera_info the last few, because either of the two connections may be ahead.
  std::deque<sensor_msgs::ImageConstPtr> images_;
  std::deque<sensor_msgs::CameraInfoConstPtr> infos_;
};

}  // namespace robot_vision
