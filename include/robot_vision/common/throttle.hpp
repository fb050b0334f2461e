#pragma once

#include <chrono>
#include <optional>

namespace robot_vision
{

/// Lets one message through in five seconds. rosconsole's own throttle counts per line of code, so that errors of one
/// nodelet would silence those of another one in the same process.
class Throttle
{
public:
  bool due()
  {
    const auto now = std::chrono::steady_clock::now();
    if (last_ && now - *last_ < std::chrono::seconds(5)) return false;
    last_ = now;
    return true;
  }

  /// Lets the next message through at once.
  void reset() { last_.reset(); }

private:
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace robot_vision
