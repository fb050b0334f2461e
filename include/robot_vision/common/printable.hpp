#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

/// What somebody else has sent, as a part of one line of text: whatever is not a plain letter, sign or blank of ASCII
/// is written as \xNN, so that it ends no line and tells no terminal what to do; what is longer than `length` ends in
/// "...".
std::string printable(const std::string& text, std::size_t length = 100);

/// The same for UTF-8 text, whose letters stay as they are; as many bytes of it as fit into `length`, then "...".
std::string shortened(const std::string& text, std::size_t length = 200);

/// The same for what is a line of a log by itself, such as an error with a path in it: what is too long lacks its
/// middle.
std::string logLine(const std::string& text);

}  // namespace robot_vision
