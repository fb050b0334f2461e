#include "robot_vision/common/printable.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxLine = 900;   // bytes of a line of a log
constexpr std::size_t kKeptTail = 300;  // bytes kept from the end of a longer line, where the reason usually stands

bool isContinuationByte(const std::string& text, std::size_t at)
{
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0u) == 0x80u;
}

std::string escaped(unsigned char byte)
{
  constexpr const char* kDigits = "0123456789abcdef";
  return {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 0xF]};
}

/// Whether a code point ends a line or a paragraph, or changes the direction of writing.
bool isInvisible(std::uint32_t code_point)
{
  return (code_point >= 0x200E && code_point <= 0x200F) || (code_point >= 0x2028 && code_point <= 0x202E) ||
         (code_point >= 0x2066 && code_point <= 0x2069);
}

/// The number of bytes of the UTF-8 character at `at`, or 0 if the bytes are no character or must not reach a terminal.
std::size_t characterSize(const std::string& text, std::size_t at)
{
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(i < text.size() ? text[i] : '\0'); };
  const std::uint32_t first = byte(at);
  if (first < 0x80) return first >= ' ' && first != 0x7F ? 1 : 0;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return 0;
  std::uint32_t code_point = first & (0x7Fu >> size);
  for (std::size_t i = at + 1; i < at + size; ++i)
  {
    if ((byte(i) & 0xC0u) != 0x80) return 0;
    code_point = code_point << 6 | (byte(i) & 0x3Fu);
  }
  return code_point < 0xA0 || isInvisible(code_point) ? 0 : size;
}

}  // namespace

std::string printable(const std::string& text, std::size_t length)
{
  const std::string dots = "...";
  std::string line;
  for (const char character : text.substr(0, length + 1))
  {
    const auto byte = static_cast<unsigned char>(character);
    if (byte >= ' ' && byte <= '~')
      line += character;
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
    const std::size_t size = characterSize(text, next);
    const std::string shown = size == 0 ? escaped(static_cast<unsigned char>(text[next])) : text.substr(next, size);
    if (line.size() + shown.size() > length) return line + "...";
    line += shown;
    next += std::max<std::size_t>(size, 1);
  }
  return line;
}

std::string logLine(const std::string& text)
{
  const std::string line = shortened(text, std::numeric_limits<std::size_t>::max());
  if (line.size() <= kMaxLine) return line;
  std::size_t tail = line.size() - kKeptTail;
  while (isContinuationByte(line, tail))
    ++tail;
  return shortened(line, kMaxLine - kKeptTail) + line.substr(tail);
}

}  // namespace robot_vision
