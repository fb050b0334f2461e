#pragma once

#include <algorithm>
#include <chrono>

namespace robot_vision
{

/// How long something that has failed is left alone: at first for a short time, and each time for twice as long as
/// before, up to a limit. It is short again after it went well for as long as the last pause.
class GrowingPause
{
public:
  using Clock = std::chrono::steady_clock;

  GrowingPause(Clock::duration min, Clock::duration max) : min_(min), max_(max) {}

  /// It has failed now; whether it has also gone well since the last pause.
  void begin(Clock::time_point now, bool went_well)
  {
    const bool went_long = went_well && now - until_ >= pause_;
    pause_ = went_long ? min_ : std::clamp(2 * pause_, min_, max_);
    until_ = now + pause_;
  }

  bool isOn(Clock::time_point now) const { return now < until_; }

private:
  const Clock::duration min_, max_;
  Clock::duration pause_{};  // the last one
  Clock::time_point until_;
};

}  // namespace robot_vision
