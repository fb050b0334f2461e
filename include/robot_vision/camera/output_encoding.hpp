#pragma once

#include <string>

namespace robot_vision
{

/// Throws std::invalid_argument unless `wanted` is a value of the parameter output_encoding: auto, bgr8, rgb8, mono8 or
/// native.
void validateOutputEncoding(const std::string& wanted);

/// The encoding of ~image_raw for frames of the encoding `given`. auto is mono8 for gray cameras and bgr8 for all
/// others. native is the given encoding under its name in sensor_msgs (10-bit gray becomes mono16), or bgr8 if
/// sensor_msgs has no name for it. Depths stay what they are, whatever is wanted.
std::string outputEncoding(const std::string& wanted, const std::string& given);

}  // namespace robot_vision
