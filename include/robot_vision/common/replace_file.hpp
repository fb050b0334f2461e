#pragma once

#include <string>

namespace robot_vision
{

/// Writes or replaces a file in one step or not at all. The new file has the permissions of the old one and, as far as
/// this user may give files away, its owner. If the path is a symbolic link, the file that it leads to is replaced.
/// Throws std::runtime_error naming the path if it is no regular file, and std::system_error if it cannot be written.
void replaceFile(const std::string& path, const std::string& text);

}  // namespace robot_vision
