#pragma once

#include <ros/node_handle.h>

#include <string>

namespace robot_vision
{

// What is needed to find images of several cameras that belong together by their stamps.

/// Reads ~slop (s), how far the stamps may differ. Throws std::invalid_argument if it is out of range.
double readSlop(const ros::NodeHandle& pnh, double otherwise);

/// The time between two stamps, s, never negative. Exact, and for any stamps: ros::Duration ends at 68 years.
double secondsBetween(const ros::Time& a, const ros::Time& b);

/// A stamp as "12.000000034", s.
std::string timeText(const ros::Time& stamp);

}  // namespace robot_vision
