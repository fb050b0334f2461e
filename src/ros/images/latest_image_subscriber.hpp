#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "frame_statistics.hpp"
#include "process_images.hpp"
#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// A received image.
struct ReceivedImage
{
  std_msgs::Header header;
  ProcessFrame::Pixels pixels;  // not to be written, because other subscribers in the process may share them
  std::string encoding;         // of the pixels
  sensor_msgs::CameraInfoConstPtr camera_info;  // with the same stamp, if it is wanted
};

/// Receives the newest image of a topic over any image_transport. Messages are only stored when they arrive; take()
/// converts, refuses and counts them, so that images that nobody takes cost nothing. Only one thread may call take();
/// the rest is thread-safe.
class LatestImageSubscriber : private ProcessImages::Listener
{
public:
  struct Params
  {
    std::string topic;              // absolute; it is not remapped any more
    std::string transport = "raw";  // raw, compressed, ...; the parameter image_transport does not override it
    std::string parameters = "~";   // namespace of the transport's own parameters, if this is the first of the topic
    std::string encoding;           // encoding to convert to; "" for no conversion
    std::string camera_info_topic;  // absolute topic of the camera_info to pair with each image; "" for none
  };

  /// What the subscriber has of its node.
  struct Node
  {
    ros::NodeHandle nh;  // through whose queue camera_info comes
    std::shared_ptr<ProcessSubscriptions> subscriptions;
    std::shared_ptr<Waker> waker;  // of the thread that calls take()
  };

  /// Throws std::invalid_argument if the encoding is unknown.
  LatestImageSubscriber(const Params& params, Node node, std::shared_ptr<FrameStatistics> statistics);
  ~LatestImageSubscriber() override { end(); }
  LatestImageSubscriber(const LatestImageSubscriber&) = delete;
  LatestImageSubscriber& operator=(const LatestImageSubscriber&) = delete;

  void open();   // subscribes; if the master does not answer, it waits until roscpp is shut down
  void close();  // unsubscribes and drops images that were not taken yet
  void end();    // closes it for good
  std::uint32_t publishers() const;

  /// The newest image since the last call, empty if there is none. An image that cannot be used is refused.
  std::optional<ReceivedImage> take();
  /// The image that was taken last has been processed, and its results are published.
  void finished();
  /// The same of an image with this stamp that was taken some time ago; working on it has taken so many seconds.
  void finishedLater(double processing_s, const ros::Time& stamp);
  /// The processing of that image has failed, and the caller has logged it; the image counts as refused.
  void failed(const std::string& reason);

  FrameStatistics::Totals totals() const { return statistics_->totals(); }

private:
  void onComing() override { node_.waker->wake(); }
  void onFrame(const std::shared_ptr<ProcessFrame>& frame) override;
  void refuse(const sensor_msgs::Image& message, const std::string& reason);
  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info);
  std::shared_ptr<ProcessFrame> takeNewest(ReceivedImage& received);
  std::shared_ptr<ProcessImages> images() const;
  sensor_msgs::CameraInfoConstPtr infoOf(const sensor_msgs::Image& image) const;

  Params params_;
  Node node_;
  std::shared_ptr<FrameStatistics> statistics_;
  Throttle throttle_;
  ros::Time taken_stamp_;
  FrameStatistics::Clock::time_point taken_at_;

  mutable std::mutex mutex_;  // guards all below
  bool open_ = false;
  bool ended_ = false;
  std::shared_ptr<ProcessImages> images_;
  ros::Subscriber info_subscriber_;
  // The newest image; with camera_info the last few, because either of the two connections may be ahead.
  std::deque<std::shared_ptr<ProcessFrame>> frames_;
  std::deque<sensor_msgs::CameraInfoConstPtr> infos_;
};

}  // namespace robot_vision
