#include "image_header.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string>

#include "png.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint64_t kTooLargeSide = std::uint64_t{1} << 32;  // px, larger than any side that is accepted

/// The bytes of a file. Reading beyond its end gives 0.
class Bytes
{
public:
  Bytes(const unsigned char* data, std::size_t size) : data_(data), size_(size) {}

  bool has(std::size_t at, std::size_t count) const { return at <= size_ && count <= size_ - at; }

  bool beginsWith(const char* text, std::size_t count, std::size_t at = 0) const
  {
    return has(at, count) && std::memcmp(data_ + at, text, count) == 0;
  }

  std::uint64_t number(std::size_t at, std::size_t count, bool big_endian = false) const
  {
    std::uint64_t value = 0;
    for (std::size_t i = 0; has(at, count) && i < count; ++i)
      value = value << 8 | data_[at + (big_endian ? i : count - 1 - i)];
    return value;
  }

  unsigned char operator[](std::size_t at) const { return has(at, 1) ? data_[at] : '\0'; }
  std::size_t size() const { return size_; }

private:
  const unsigned char* data_;
  std::size_t size_;
};

/// The length of a side of a BMP, whose sign tells where the rows begin.
std::uint64_t side(std::uint64_t bits)
{
  const std::int64_t value = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
  return static_cast<std::uint64_t>(value < 0 ? -value : value);
}

std::optional<ClaimedSize> sizeOfBmp(const Bytes& file)
{
  constexpr std::uint64_t kOldHeader = 12;  // bytes of the header of OS/2, which has 16 bits for a side
  if (file.number(14, 4) == kOldHeader) return ClaimedSize{file.number(18, 2), file.number(20, 2)};
  return ClaimedSize{side(file.number(18, 4)), side(file.number(22, 4))};
}

/// Reads a decimal number from `at` on, after blanks and comments, and moves `at` behind it. Nothing if no blank
/// follows the number: OpenCV skips any byte there, so that it would not see a comment begin.
std::optional<std::uint64_t> decimal(const Bytes& file, std::size_t& at)
{
  while (std::isspace(file[at]) != 0 || file[at] == '#')
  {
    const bool comment = file[at] == '#';
    while (comment && file.has(at, 1) && file[at] != '\n' && file[at] != '\r')
      ++at;
    ++at;
  }
  if (std::isdigit(file[at]) == 0) return std::nullopt;
  std::uint64_t value = 0;
  for (; std::isdigit(file[at]) != 0; ++at)
    value = std::min<std::uint64_t>(10 * value + (file[at] - '0'), kTooLargeSide);
  if (std::isspace(file[at]) == 0) return std::nullopt;
  return value;
}

std::optional<ClaimedSize> sizeOfPnm(const Bytes& file)
{
  std::size_t at = 2;
  const auto width = decimal(file, at);
  const auto height = decimal(file, at);
  if (!width || !height) return std::nullopt;
  return ClaimedSize{*width, *height};
}

constexpr std::size_t kMaxPamHeader = 4096;  // bytes; with some 100 lines more would take long to be looked through

/// The largest number that follows a keyword in the header. OpenCV takes the last one.
std::uint64_t maxPamNumber(const Bytes& file, const std::string& keyword, std::size_t end)
{
  std::uint64_t max = 0;
  for (std::size_t at = 0; at < end; ++at)
  {
    if (!file.beginsWith(keyword.data(), keyword.size(), at)) continue;
    std::size_t behind = at + keyword.size();
    max = std::max(max, decimal(file, behind).value_or(0));
  }
  return max;
}

std::optional<ClaimedSize> sizeOfPam(const Bytes& file)
{
  const std::string last = "\nENDHDR";  // at the begin of a line, because a comment may contain the word
  std::size_t end = 0;
  while (end < kMaxPamHeader && !file.beginsWith(last.data(), last.size(), end))
    ++end;
  if (end == kMaxPamHeader) return std::nullopt;
  return ClaimedSize{maxPamNumber(file, "WIDTH", end), maxPamNumber(file, "HEIGHT", end)};
}

/// The size of the first image of a TIFF, or of a BigTIFF, whose numbers are wider.
std::optional<ClaimedSize> sizeOfTiff(const Bytes& file)
{
  constexpr std::uint64_t kWidthTag = 256, kHeightTag = 257, kShort = 3, kLong = 4;
  const bool big_endian = file[0] == 'M';
  const bool wide = file.number(2, 2, big_endian) == 43;
  const std::size_t offset = wide ? 8 : 4, count_bytes = wide ? 8 : 2, entry_bytes = wide ? 20 : 12;
  const std::uint64_t first = file.number(offset, wide ? 8 : 4, big_endian);
  if (first > file.size()) return std::nullopt;
  const std::uint64_t count = file.number(first, count_bytes, big_endian);
  ClaimedSize size;
  for (std::uint64_t i = 0, at = first + count_bytes; i < count && file.has(at, entry_bytes); ++i, at += entry_bytes)
  {
    const std::uint64_t tag = file.number(at, 2, big_endian);
    const std::uint64_t type = file.number(at + 2, 2, big_endian);
    const std::size_t value_bytes = type == kShort ? 2 : type == kLong ? 4 : 8;
    const std::uint64_t value = file.number(at + (wide ? 12 : 8), value_bytes, big_endian);
    if (tag == kWidthTag) size.width = std::max(size.width, value);
    if (tag == kHeightTag) size.height = std::max(size.height, value);
  }
  return size;
}

std::optional<ClaimedSize> sizeOfWebp(const Bytes& file)
{
  constexpr std::uint64_t kSide = 0x3FFF;  // 14 bits
  if (file.beginsWith("VP8X", 4, 12)) return ClaimedSize{file.number(24, 3) + 1, file.number(27, 3) + 1};
  if (file.beginsWith("VP8 ", 4, 12)) return ClaimedSize{file.number(26, 2) & kSide, file.number(28, 2) & kSide};
  if (!file.beginsWith("VP8L", 4, 12)) return std::nullopt;
  const std::uint64_t bits = file.number(21, 4);
  return ClaimedSize{(bits & kSide) + 1, (bits >> 14 & kSide) + 1};
}

bool isTiff(const Bytes& file)
{
  return file.beginsWith("II*\0", 4) || file.beginsWith("MM\0*", 4) || file.beginsWith("II+\0", 4) ||
         file.beginsWith("MM\0+", 4);
}

std::optional<ClaimedSize> sizeOfOtherFormats(const Bytes& file)
{
  if (file.beginsWith("BM", 2)) return sizeOfBmp(file);
  if (file.beginsWith("P7", 2)) return sizeOfPam(file);
  if (file[0] == 'P' && file[1] != '\0' && std::strchr("123456fF", file[1]) != nullptr) return sizeOfPnm(file);
  if (isTiff(file)) return sizeOfTiff(file);
  if (file.beginsWith("RIFF", 4) && file.beginsWith("WEBP", 4, 8)) return sizeOfWebp(file);
  if (file.beginsWith("\x59\xA6\x6A\x95", 4)) return ClaimedSize{file.number(4, 4, true), file.number(8, 4, true)};
  return std::nullopt;
}

}  // namespace

std::optional<ClaimedSize> claimedSize(const unsigned char* data, std::size_t size)
{
  const Bytes file(data, size);
  std::optional<ClaimedSize> claimed;
  if (isPng(data, size))
  {
    if (file.beginsWith("IHDR", 4, 12))  // any other first chunk would be removed before the file is decoded
      claimed = ClaimedSize{file.number(16, 4, true), file.number(20, 4, true)};
  }
  else if (file.beginsWith("\xFF\xD8", 2))
    claimed = ClaimedSize{static_cast<std::uint64_t>(claimedJpegSize(data, size).width),
                          static_cast<std::uint64_t>(claimedJpegSize(data, size).height)};
  else
    claimed = sizeOfOtherFormats(file);
  const bool has_pixels = claimed && claimed->width > 0 && claimed->height > 0;
  return has_pixels ? claimed : std::nullopt;
}

}  // namespace robot_vision
