#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

/// The bytes of a regular file, at most `max_size`; anything else may block, as a pipe does, or never end. Throws
/// std::runtime_error naming the path: it is no regular file, too large, or (std::system_error) cannot be read.
std::string readFile(const std::string& path, std::size_t max_size);

}  // namespace robot_vision
