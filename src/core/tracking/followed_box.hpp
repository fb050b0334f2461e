#pragma once

#include <cstddef>
#include <cstdint>

#include "box_motion.hpp"
#include "robot_vision/tracking/box_tracker.hpp"

namespace robot_vision
{

/// What a BoxTracker knows of one track.
class FollowedBox
{
public:
  /// Begins one with a detection, which has this index in its list.
  FollowedBox(const BoxDetection& detection, std::size_t index, double time_s, const BoxTrackerParams& params);

  bool isConfirmed() const { return id_ > 0; }
  bool isLost() const { return lost_; }
  bool hasDetection() const { return detection_ >= 0; }
  int classId() const { return class_id_; }
  int hits() const { return hits_; }
  double lastSeen() const { return seen_s_; }
  cv::Rect2d box() const { return motion_.box(); }
  double centerVariance() const { return motion_.centerVariance(); }

  /// How far, in px, it may be from where it is expected, if it turns back or, while its velocity is not known, moves
  /// by more than its size.
  double reach(double time_s, const BoxTrackerParams& params) const;

  /// Moves it by the camera's motion, then by its own.
  void predict(const Warp& warp, double elapsed, const BoxTrackerParams& params);

  /// It has no detection in the frame of a new result so far.
  void beginResult() { detection_ = -1; }

  /// This is its detection there.
  void setSeen(const BoxDetection& detection, std::size_t index, double time_s, const BoxTrackerParams& params);

  /// It has none.
  void setLost();

  void confirm(std::int64_t id) { id_ = id; }

  /// How it is reported in the frame at `time_s`, which it was predicted to.
  BoxTrack report(double time_s) const;

private:
  void countClass(const BoxDetection& detection);

  BoxMotion motion_;
  std::int64_t id_ = 0;  // 0: not confirmed
  int detection_;        // -1: none
  int class_id_;
  double class_weight_;  // the scores of the detections of its class less those of others, up to a limit
  double score_;
  double seen_s_;
  int hits_ = 1;
  bool lost_ = false;
};

}  // namespace robot_vision
