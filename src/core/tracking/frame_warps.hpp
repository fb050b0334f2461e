#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <optional>

namespace robot_vision
{

/// Takes pixels of one frame to those of another: x' = w00 x + w01 y + w02, y' = w10 x + w11 y + w12.
using Warp = cv::Matx23d;

/// By how much a warp enlarges lengths: the root of what it does to areas. NaN if it mirrors the image.
double scaleOf(const Warp& warp);

cv::Point2d warped(const Warp& warp, const cv::Point2d& point);

/// Throws std::invalid_argument naming `warp` unless its numbers are finite and it neither mirrors the image nor makes
/// it more than 10 times as large or as small.
void checkWarp(const Warp& warp);

/// How the camera has moved from one frame, the origin, by way of all later ones to the newest.
class FrameWarps
{
public:
  /// Forgets all frames; the one at `time_s` is the origin, and the newest.
  void start(double time_s);

  bool empty() const { return !origin_s_; }
  double origin() const { return *origin_s_; }                                            // s
  double newest() const { return frames_.empty() ? *origin_s_ : frames_.back().time_s; }  // s

  /// Adds a frame that is not earlier than the newest, and the motion from that one to it. Returns false, and is to be
  /// started again, if so much has come together that nothing of the origin's can be in view.
  bool add(double time_s, const Warp& warp);

  /// From the origin to the newest frame.
  const Warp& toNewest() const { return to_newest_; }

  /// Makes the last frame that is not later than `time_s` the origin, with this time, which is not before the origin's.
  /// Returns the motion from the old origin to it.
  Warp moveOrigin(double time_s);

private:
  struct Frame
  {
    double time_s;
    Warp from_last;
  };

  std::optional<double> origin_s_;
  std::deque<Frame> frames_;  // after the origin
  Warp to_newest_;
};

}  // namespace robot_vision
