#pragma once

#include <string>

namespace robot_vision
{

/// Throws std::runtime_error if a file is one of this package's, and not roslaunch has started this process: then it is
/// not the file of its launch file, but has been left on the parameter server by one that has ended.
void requireOwnLaunch(const std::string& path);

}  // namespace robot_vision
