#pragma once

#include <string>

namespace robot_vision
{

/// Throws std::invalid_argument unless `wanted` is a value of the parameter output_encoding: auto, bgr8, rgb8, mono8 or
/// native.
void validateOutputEncoding(const std::string& wanted);

/// The encoding of ~image_raw for frames of the encoding `given`. auto: mono8 of gray cameras, bgr8 of all others.
/// native: what is given, in its name in sensor_msgs (10 bits of gray as mono16), or bgr8 where there is none.
std::string outputEncoding(const std::string& wanted, const std::string& given);

}  // namespace robot_vision
