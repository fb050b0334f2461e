#pragma once

#include <time.h>

#include <cstdint>

namespace robot_vision
{

/// The time of CLOCK_MONOTONIC in ns. V4L2 drivers stamp frames with this clock.
inline std::int64_t monotonicNow()
{
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000000000LL + now.tv_nsec;
}

}  // namespace robot_vision
