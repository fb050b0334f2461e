#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

constexpr std::size_t kMaxYamlText = std::size_t{1} << 20;  // bytes, of a parameter or calibration file
constexpr std::size_t kMaxYamlDepth = 20;
constexpr std::size_t kMaxYamlValues = 10000;  // including those that aliases stand for

/// Throws YAML::ParserException, which names the position, for text that is not valid YAML or exceeds these limits.
/// Some versions of yaml-cpp recurse without a limit, and a few aliases of aliases can stand for an astronomical number
/// of values.
void requireBoundedYaml(const std::string& text);

}  // namespace robot_vision
