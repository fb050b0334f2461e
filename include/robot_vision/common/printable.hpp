#pragma once

#include <cstddef>
#include <string>

namespace robot_vision
{

/// Makes text that somebody else has sent fit into one line: each byte that is not a printable ASCII character becomes
/// \xNN, so that the text can neither end the line nor control a terminal. The result has at most `length` bytes; the
/// last three are "..." if it was cut.
std::string printable(const std::string& text, std::size_t length = 100);

/// The same for UTF-8 text, whose characters stay as they are. Whole characters are kept up to `length` bytes; "..."
/// follows if that was not all.
std::string shortened(const std::string& text, std::size_t length = 200);

/// The same for a whole line of a log, such as an error with a path in it: a line that is too long loses its middle.
std::string logLine(const std::string& text);

}  // namespace robot_vision
