#pragma once

#include <string>

#include "byte_stream.hpp"

namespace robot_vision
{

// The bytes of each trained model begin with a magic, the version of the format, and the name of the method.

void writeModelHead(const std::string& method, ByteWriter& to);

/// Throws std::invalid_argument unless the head is that of a model of this method, which this version can read.
void checkModelHead(const std::string& method, ByteReader& from);

}  // namespace robot_vision
