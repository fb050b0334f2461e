#pragma once

#include <atomic>
#include <chrono>

namespace robot_vision
{

/// Lets one message through in five seconds. rosconsole's own throttle counts per line of code, so that errors of one
/// nodelet would silence those of another one in the same process. Thread-safe.
class Throttle
{
public:
  bool due()
  {
    const TimePoint now = Clock::now();
    TimePoint last = last_;
    if (last != kNever && now - last < std::chrono::seconds(5)) return false;
    return last_.compare_exchange_strong(last, now);  // else another thread's message goes through
  }

  /// Lets the next message through at once.
  void reset() { last_ = kNever; }

private:
  using Clock = std::chrono::steady_clock;
  using TimePoint = Clock::time_point;

  static constexpr TimePoint kNever = TimePoint::min();

  std::atomic<TimePoint> last_{kNever};
};

}  // namespace robot_vision
