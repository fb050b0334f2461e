#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

/// What somebody else has sent, as a part of one line of text: whatever is not a plain letter, sign or blank of ASCII
/// is written as \xNN, so that it ends no line and tells no terminal what to do; what is longer than `length` ends in
/// "...".
std::string printable(const std::string& text, std::size_t length = 100);

/// UTF-8 text, or "..." after as much of it as fits into `length` bytes and ends with a whole letter.
std::string shortened(const std::string& text, std::size_t length);

}  // namespace robot_vision
