#pragma once

#include <string>

namespace robot_vision
{

/// Writes a file, or replaces it, in one step or not at all. An old file keeps its permissions; of a symbolic link the
/// file it leads to is replaced. Throws std::system_error that says why it cannot be written.
void replaceFile(const std::string& path, const std::string& text);

}  // namespace robot_vision
