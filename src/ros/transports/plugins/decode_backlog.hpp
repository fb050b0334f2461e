#pragma once

#include <chrono>
#include <cstdint>

namespace robot_vision
{

/// Tells whether the messages that wait can be decoded in time, by how long those before them took.
class DecodeBacklog
{
public:
  using Duration = std::chrono::duration<double>;

  static constexpr Duration kMaxDelay{0.5};

  void decoded(Duration took) { mean_ += (took - mean_) / 8.0; }

  bool isTooLong(std::int64_t waiting) const { return static_cast<double>(waiting) * mean_ > kMaxDelay; }

private:
  Duration mean_{0.0};
};

}  // namespace robot_vision
