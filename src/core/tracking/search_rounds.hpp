#pragma once

#include <optional>
#include <vector>

#include "core/features/object_features.hpp"
#include "followed_object.hpp"

namespace robot_vision
{

/// Shares the search for lost objects among frames: in each round it is the turn of all of them, of a few in a frame.
/// Otherwise a frame with many lost objects would take so long that those in view are lost, too.
class SearchRounds
{
public:
  /// Chooses those of the lost objects whose turn it is in the frame at `time_s`. Rounds begin at least `period` (s)
  /// apart, or when the time goes backwards.
  std::vector<FollowedObject*> choose(std::vector<FollowedObject*> lost, double time_s, double period);

  /// Finds `count` features of the frame `gray` at `time_s`, or returns those of an earlier frame of the same size that
  /// are younger than `period` (s) and than 0.25 s.
  const Features& features(const cv::Mat& gray, int count, double time_s, double period);

private:
  int round_ = 0;
  double began_ = -1e300;  // s, when the round did
  bool is_over_ = true;
  Features features_;
  double features_time_ = -1e300;  // s
  cv::Size features_size_;         // px, of the image that they are of
};

}  // namespace robot_vision
