#pragma once

#include <string>

namespace robot_vision
{

/// Throws std::runtime_error if a file belongs to this package but roslaunch did not start this process. Then the
/// file's name was left on the parameter server by a launch that has ended.
void requireOwnLaunch(const std::string& path);

}  // namespace robot_vision
