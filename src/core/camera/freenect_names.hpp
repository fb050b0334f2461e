#pragma once

#include <string>

namespace robot_vision
{

/// The number of a Kinect in the order in which they are found, from 0 on, by a name such as 0 or #1, where nothing is
/// the first one; -1 for a name that is no such number.
int freenectIndex(const std::string& name);

/// "; " and what helps against an error that libfreenect has logged; empty if that is not known.
std::string freenectAdvice(const std::string& log);

}  // namespace robot_vision
