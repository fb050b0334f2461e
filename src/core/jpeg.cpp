#include "robot_vision/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr unsigned char kStartOfImage = 0xD8;
constexpr unsigned char kEndOfImage = 0xD9;
constexpr unsigned char kStartOfScan = 0xDA;
constexpr unsigned char kFirstRestart = 0xD0;
constexpr unsigned char kLastRestart = 0xD7;

/// The position of the marker that ends the scan's entropy-coded data at `i`, or `size`.
std::size_t skipScan(const unsigned char* data, std::size_t size, std::size_t i)
{
  for (; i + 1 < size; ++i)
  {
    if (data[i] != 0xFF) continue;
    const unsigned char next = data[i + 1];
    const bool stuffed = next == 0x00 || next == 0xFF;
    const bool restart = next >= kFirstRestart && next <= kLastRestart;
    if (!stuffed && !restart) return i;
  }
  return size;
}

}  // namespace

bool isCompleteJpeg(const unsigned char* data, std::size_t size)
{
  if (size < 4 || data[0] != 0xFF || data[1] != kStartOfImage) return false;
  std::size_t i = 2;
  while (i + 1 < size && data[i] == 0xFF)
  {
    const unsigned char marker = data[i + 1];
    if (marker == kEndOfImage) return true;
    if (marker == 0xFF)  // fill byte
    {
      ++i;
      continue;
    }
    if (i + 3 >= size) return false;
    i += 2 + (static_cast<std::size_t>(data[i + 2]) << 8 | data[i + 3]);
    if (marker == kStartOfScan) i = skipScan(data, size, i);
  }
  return false;
}

}  // namespace robot_vision
