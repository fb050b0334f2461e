#include "frame_warps.hpp"

#include <cmath>
#include <string>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxFrames = 512;  // after the origin; of more the first are put together
constexpr double kMaxScale = 10.0;       // of a warp between two frames
constexpr double kMaxTotalScale = 1e3;   // of what many of them amount to
constexpr double kMaxTotalShift = 1e7;   // px

const Warp kIdentity(1, 0, 0, 0, 1, 0);

/// The warp that does first `inner`, then `outer`.
Warp composed(const Warp& outer, const Warp& inner)
{
  const cv::Matx33d all(inner(0, 0), inner(0, 1), inner(0, 2), inner(1, 0), inner(1, 1), inner(1, 2), 0, 0, 1);
  return outer * all;
}

}  // namespace

double scaleOf(const Warp& warp)
{
  return std::sqrt(warp(0, 0) * warp(1, 1) - warp(0, 1) * warp(1, 0));
}

cv::Point2d warped(const Warp& warp, const cv::Point2d& point)
{
  const cv::Vec2d moved = warp * cv::Vec3d(point.x, point.y, 1.0);
  return {moved[0], moved[1]};
}

void checkWarp(const Warp& warp)
{
  for (const double value : warp.val)
    requireFinite("warp", value);
  require(std::abs(warp(0, 2)) <= kMaxTotalShift && std::abs(warp(1, 2)) <= kMaxTotalShift, "warp",
          "a shift by (" + toText(warp(0, 2)) + ", " + toText(warp(1, 2)) + ") px", "up to 1e7 px");
  const double scale = scaleOf(warp);
  require(scale >= 1.0 / kMaxScale && scale <= kMaxScale, "warp",
          "of determinant " + toText(warp(0, 0) * warp(1, 1) - warp(0, 1) * warp(1, 0)),
          "regular, with a determinant from 0.01 to 100");
}

void FrameWarps::start(double time_s)
{
  origin_s_ = time_s;
  frames_.clear();
  to_newest_ = kIdentity;
}

bool FrameWarps::add(double time_s, const Warp& warp)
{
  frames_.push_back({time_s, warp});
  to_newest_ = composed(warp, to_newest_);
  if (frames_.size() > kMaxFrames)
  {
    frames_[1].from_last = composed(frames_[1].from_last, frames_[0].from_last);
    frames_.pop_front();
  }
  const double scale = scaleOf(to_newest_), shift = std::hypot(to_newest_(0, 2), to_newest_(1, 2));
  return scale >= 1.0 / kMaxTotalScale && scale <= kMaxTotalScale && shift <= kMaxTotalShift;
}

Warp FrameWarps::moveOrigin(double time_s)
{
  Warp passed = kIdentity;
  while (!frames_.empty() && frames_.front().time_s <= time_s)
  {
    passed = composed(frames_.front().from_last, passed);
    frames_.pop_front();
  }
  origin_s_ = time_s;
  to_newest_ = kIdentity;
  for (const Frame& frame : frames_)
    to_newest_ = composed(frame.from_last, to_newest_);
  return passed;
}

}  // namespace robot_vision
