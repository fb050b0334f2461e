#pragma once

#include <image_transport/image_transport.h>
#include <sensor_msgs/CameraInfo.h>

#include <deque>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "core/common/throttle.hpp"
#include "frame_statistics.hpp"
#include "image_subscription.hpp"

namespace robot_vision
{

/// A picture that came in.
struct ReceivedImage
{
  sensor_msgs::ImageConstPtr message;  // owns the pixels; null if they were converted and own themselves
  std_msgs::Header header;
  cv::Mat pixels;                               // not to be written: other subscribers of the process may share them
  std::string encoding;                         // of the pixels
  sensor_msgs::CameraInfoConstPtr camera_info;  // of the same stamp, if it was asked for
};

/// The newest picture of a topic, over any image_transport. Messages are put aside as they come; they are converted,
/// refused and counted in take(), so that pictures that nobody takes cost nothing. take() belongs to one thread, the
/// rest is thread-safe.
class LatestImageSubscriber
{
public:
  struct Params
  {
    std::string topic;              // absolute, it is not remapped any more
    std::string transport = "raw";  // raw, compressed, ...; whatever the parameter image_transport says
    std::string parameters = "~";   // namespace of the transport's own parameters
    std::string encoding;           // to convert to; "": as it comes
    std::string camera_info_topic;  // to pair with, absolute; "": none
  };

  /// `nh` and `it` bring the queue that the messages come through; once `it` is gone, the inbox stays closed.
  /// Throws std::invalid_argument if there is no such encoding, or naming the installed transports if the one asked
  /// for is not among them.
  LatestImageSubscriber(const Params& params, const ros::NodeHandle& nh,
                        const std::shared_ptr<image_transport::ImageTransport>& it,
                        std::shared_ptr<FrameStatistics> statistics);
  ~LatestImageSubscriber() { close(); }
  LatestImageSubscriber(const LatestImageSubscriber&) = delete;
  LatestImageSubscriber& operator=(const LatestImageSubscriber&) = delete;

  void open();   // subscribes; waits for a master that does not answer, until roscpp is shut down
  void close();  // unsubscribes, and forgets a picture that was not taken yet
  std::uint32_t publishers() const;

  /// The newest picture since the last call, or none. A picture that cannot be used is refused.
  std::optional<ReceivedImage> take();
  /// The picture that was taken last has been worked on, and its results have gone out.
  void finished();
  /// Working on it has failed, which the caller has logged: it counts as refused.
  void failed(const std::string& why);

  FrameStatistics::Totals totals() const { return statistics_->totals(); }

private:
  void refuse(const sensor_msgs::Image& message, const std::string& why);
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
  // The newest, and if camera_info is asked for the last few: they come on two connections, either may be ahead.
  std::deque<sensor_msgs::ImageConstPtr> images_;
  std::deque<sensor_msgs::CameraInfoConstPtr> infos_;
};

}  // namespace robot_vision
