#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

constexpr std::size_t kMaxYamlText = std::size_t{1} << 20;  // bytes, of a file of parameters or a calibration
constexpr std::size_t kMaxYamlDepth = 20;
constexpr std::size_t kMaxYamlValues = 10000;  // with what aliases stand for

/// Throws YAML::ParserException, which says where, for text that is no YAML, or nested or repeated beyond these limits:
/// some versions of yaml-cpp recurse without any, and a few aliases of aliases mean more values than there are atoms.
void requireBoundedYaml(const std::string& text);

}  // namespace robot_vision
