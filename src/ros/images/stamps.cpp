#include "stamps.hpp"

#include <cstdint>
#include <cstdio>

#include "robot_vision/common/range.hpp"
#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxSlop = 10.0;  // s
constexpr double kNsPerSecond = 1e9;

}  // namespace

double readSlop(const ros::NodeHandle& pnh, double otherwise)
{
  double slop = otherwise;
  readParam(pnh, "slop", slop);
  requireRange("slop", slop, 0.0, kMaxSlop);
  return slop;
}

double secondsBetween(const ros::Time& a, const ros::Time& b)
{
  const std::uint64_t first = a.toNSec(), second = b.toNSec();
  return static_cast<double>(first > second ? first - second : second - first) / kNsPerSecond;
}

std::string timeText(const ros::Time& stamp)
{
  char text[40];
  std::snprintf(text, sizeof(text), "%u.%09u", stamp.sec, stamp.nsec);
  return text;
}

}  // namespace robot_vision
