#pragma once

#include <ros/ros.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <memory>
#include <opencv2/core/affine.hpp>
#include <optional>
#include <string>

#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// Where frames are to each other, as /tf and /tf_static say. Unlike tf2_ros::TransformListener it has no thread of its
/// own: messages come through the queue of `nh`, and only while it listens. What cannot be a transform is left out, and
/// logged now and then.
class FrameTransforms
{
public:
  explicit FrameTransforms(const ros::NodeHandle& nh) : nh_(nh) {}
  ~FrameTransforms() { listen(false); }
  FrameTransforms(const FrameTransforms&) = delete;
  FrameTransforms& operator=(const FrameTransforms&) = delete;

  /// Begins, and forgets what was before, or ends.
  void listen(bool listens);

  /// Takes points (m) of the frame `from` to the frame `to`, by what was said last; nothing as long as that is not
  /// known. A slash that a name begins with, as in times of tf_prefix, is left out.
  std::optional<cv::Affine3d> find(const std::string& to, const std::string& from) const;

private:
  ros::Subscriber subscribe(const std::string& topic, bool is_static);

  /// Forgets what is of a time to come, if the time went back, as when a bag begins anew: tf2 would take it for the
  /// newest, and leave out what is said from now on.
  void lookAtClock();

  ros::NodeHandle nh_;
  std::unique_ptr<tf2::BufferCore> buffer_;  // while it listens
  ros::Time newest_;                         // when the last message came
  Throttle throttle_;
  ros::Subscriber moving_;
  ros::Subscriber static_;
};

}  // namespace robot_vision
