#include "robot_vision/printable.hpp"

#include <algorithm>

namespace robot_vision
{

std::string printable(const std::string& text, std::size_t length)
{
  constexpr const char* kDigits = "0123456789abcdef";
  const std::string dots = "...";
  std::string line;
  for (const char letter : text.substr(0, length + 1))
  {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte >= ' ' && byte <= '~')
      line += letter;
    else
      line += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 0xF]};
  }
  if (line.size() <= length) return line;
  return line.substr(0, length - std::min(length, dots.size())) + dots;
}

std::string shortened(const std::string& text, std::size_t length)
{
  if (text.size() <= length) return text;
  std::size_t end = length;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u)  // in the middle of a letter
    --end;
  return text.substr(0, end) + "...";
}

}  // namespace robot_vision
