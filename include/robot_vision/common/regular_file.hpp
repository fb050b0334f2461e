#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

/// Reads a regular file of at most `max_size` bytes. Other files are refused: a pipe may block, and a device may never
/// end. Throws std::runtime_error naming the path if it is no regular file or too large, and std::system_error if it
/// cannot be read.
std::string readFile(const std::string& path, std::size_t max_size);

}  // namespace robot_vision
