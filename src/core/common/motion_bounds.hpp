#pragma once

#include <algorithm>

namespace robot_vision
{

/// How far, in px, an object may be from where it is expected, at a time (s) after it was seen last. Its `speed` (px/s)
/// is only known if it `is_tracked`, that is if it was seen more than once. `side` (px) is the length of its longest
/// side.
inline double motionMargin(bool is_tracked, double speed, double elapsed, double side)
{
  constexpr double kPositionError = 0.1;       // sides
  constexpr double kMotionError = 0.5;         // share of the distance that it has moved
  constexpr double kInitialMotion = 0.5;       // sides in a single frame
  constexpr double kMaxUntrackedSpeed = 15.0;  // sides/s
  constexpr double kMaxUntrackedMotion = 2.5;  // sides
  if (is_tracked) return kPositionError * side + kMotionError * speed * elapsed;
  return std::min(std::max(kMaxUntrackedSpeed * elapsed, kInitialMotion), kMaxUntrackedMotion) * side;
}

/// Whether an object can have moved by `distance` (px) in a time (s). If not, it was put to where it is now, or is
/// another one.
inline bool isMotion(double distance, double elapsed, double side)
{
  constexpr double kMaxSpeed = 60.0;  // sides/s
  return distance <= kMaxSpeed * elapsed * side;
}

}  // namespace robot_vision
