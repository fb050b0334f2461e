#pragma once

#include <string>

namespace robot_vision
{

/// Throws std::runtime_error or std::invalid_argument, whose text lacks the path that it goes on from, for a file that
/// needs no reading to be refused: it is not there, is no file, is empty or too large, or says itself that it has too
/// many triangles.
void checkMeshFile(const std::string& path);

}  // namespace robot_vision
