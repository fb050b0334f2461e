#pragma once

#include <string>

namespace robot_vision
{

/// Writes a file, or replaces it, in one step or not at all. An old file keeps its permissions and, as far as this user
/// may give it away, its owner; of a symbolic link the file it leads to is replaced. Throws std::runtime_error naming
/// the path: it is no regular file, or (std::system_error) cannot be written.
void replaceFile(const std::string& path, const std::string& text);

}  // namespace robot_vision
