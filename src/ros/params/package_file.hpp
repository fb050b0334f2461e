#pragma once

#include <string>

namespace robot_vision
{

/// Whether roslaunch started this process: it passes the name of the log file, which rosrun does not.
bool isStartedByRoslaunch();

/// Throws std::runtime_error if a file belongs to this package but roslaunch did not start this process. Then the
/// file's name was left on the parameter server by a launch that has ended.
void requireOwnLaunch(const std::string& path, bool is_started_by_roslaunch = isStartedByRoslaunch());

}  // namespace robot_vision
