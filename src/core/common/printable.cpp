#include "robot_vision/common/printable.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxLine = 900;  // bytes
constexpr std::size_t kMaxEnd = 300;   // bytes of those, of a longer line's end, which says why

/// Whether a letter has begun before.
bool isInside(const std::string& text, std::size_t at)
{
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0u) == 0x80u;
}

std::string escaped(unsigned char byte)
{
  constexpr const char* kDigits = "0123456789abcdef";
  return {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 0xF]};
}

/// Ends of lines and paragraphs, and what changes the direction of writing.
bool isInvisible(std::uint32_t letter)
{
  return (letter >= 0x200E && letter <= 0x200F) || (letter >= 0x2028 && letter <= 0x202E) ||
         (letter >= 0x2066 && letter <= 0x2069);
}

/// The bytes of the letter of UTF-8 that begins at `at`; 0: there is none, or no terminal may get it.
std::size_t letterSize(const std::string& text, std::size_t at)
{
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(i < text.size() ? text[i] : '\0'); };
  const std::uint32_t first = byte(at);
  if (first < 0x80) return first >= ' ' && first != 0x7F ? 1 : 0;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return 0;
  std::uint32_t letter = first & (0x7Fu >> size);
  for (std::size_t i = at + 1; i < at + size; ++i)
  {
    if ((byte(i) & 0xC0u) != 0x80) return 0;
    letter = letter << 6 | (byte(i) & 0x3Fu);
  }
  return letter < 0xA0 || isInvisible(letter) ? 0 : size;
}

}  // namespace

std::string printable(const std::string& text, std::size_t length)
{
  const std::string dots = "...";
  std::string line;
  for (const char letter : text.substr(0, length + 1))
  {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte >= ' ' && byte <= '~')
      line += letter;
    else
      line += escaped(byte);
  }
  if (line.size() <= length) return line;
  return line.substr(0, length - std::min(length, dots.size())) + dots;
}

std::string shortened(const std::string& text, std::size_t length)
{
  std::string line;
  std::size_t next = 0;
  while (next < text.size())
  {
    const std::size_t size = letterSize(text, next);
    const std::string letter = size == 0 ? escaped(static_cast<unsigned char>(text[next])) : text.substr(next, size);
    if (line.size() + letter.size() > length) return line + "...";
    line += letter;
    next += std::max<std::size_t>(size, 1);
  }
  return line;
}

std::string logLine(const std::string& text)
{
  const std::string line = shortened(text, std::numeric_limits<std::size_t>::max());
  if (line.size() <= kMaxLine) return line;
  std::size_t end = line.size() - kMaxEnd;
  while (isInside(line, end))
    ++end;
  return shortened(line, kMaxLine - kMaxEnd) + line.substr(end);
}

}  // namespace robot_vision
