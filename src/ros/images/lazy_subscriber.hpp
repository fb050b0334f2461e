#pragma once

#include <ros/ros.h>

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "frame_statistics.hpp"
#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// Says when a node's inputs are to be subscribed to: while its results are wanted, or always if ~always_subscribe is
/// set. Thread-safe.
class LazySubscriber
{
public:
  /// Reads the parameter. `listen` subscribes or ends that; it is called by one thread at a time, and not before
  /// start(). What it throws is logged and told by `statistics`, and it is called again a second later.
  LazySubscriber(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, FrameStatistics& statistics,
                 std::function<bool()> is_wanted, std::function<void(bool)> listen);
  ~LazySubscriber() { stop(); }
  LazySubscriber(const LazySubscriber&) = delete;
  LazySubscriber& operator=(const LazySubscriber&) = delete;

  /// Throws what `listen` throws.
  void start();
  /// Subscribes or not, as the results are wanted now; while another thread does so, it has that thread look again. To
  /// be called when their subscribers come or go.
  void update();
  /// Waits for a thread that subscribes or ends that; from now on none does.
  void stop();

private:
  std::exception_ptr look();
  void listenIfWanted();
  void tell(const std::string& reason);

  ros::NodeHandle nh_;
  const std::string name_;
  FrameStatistics& statistics_;
  std::function<bool()> is_wanted_;
  std::function<void(bool)> listen_;
  bool always_subscribe_ = false;
  std::mutex mutex_;  // guards the next three, as connections come also during the setup and the destruction
  bool running_ = false;
  bool updating_ = false;                // a thread listens or not, and only that thread uses listens_ and throttle_
  bool changed_ = false;                 // since it looked
  std::condition_variable updated_;      // updating_ is false again
  std::optional<bool> listens_ = false;  // empty if a part of that has failed
  Throttle throttle_;
  ros::WallTimer timer_;
};

}  // namespace robot_vision
