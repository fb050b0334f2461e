#include "robot_vision/image/jpeg.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

#include "core/common/big_endian.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr unsigned char kBaseline = 0xC0;
constexpr unsigned char kHuffmanTables = 0xC4;
constexpr unsigned char kReserved = 0xC8;
constexpr unsigned char kArithmeticTables = 0xCC;
constexpr unsigned char kLastFrame = 0xCF;
constexpr unsigned char kTemporary = 0x01;  // has no segment, like the restart markers
constexpr unsigned char kFirstRestart = 0xD0;
constexpr unsigned char kLastRestart = 0xD7;
constexpr unsigned char kStartOfImage = 0xD8;
constexpr unsigned char kEndOfImage = 0xD9;
constexpr unsigned char kStartOfScan = 0xDA;
constexpr unsigned char kFill = 0xFF;

/// What the markers of a stream say about it.
struct Structure
{
  bool complete = false;  // has a start, a frame, a scan and an end
  bool baseline = false;
  JpegInfo info;
  std::vector<std::uint8_t> tables;  // the segments with Huffman tables
  std::size_t first_scan = 0;        // position of the first scan's marker
};

bool beginsFrame(unsigned char marker)
{
  return marker >= kBaseline && marker <= kLastFrame && marker != kHuffmanTables && marker != kReserved &&
         marker != kArithmeticTables;
}

/// The position of the 0xFF of the next marker that begins a segment, or `size`. Skips entropy-coded data with its
/// restart markers, and the bytes that some cameras leave in front of a marker.
std::size_t findMarker(const unsigned char* data, std::size_t size, std::size_t i)
{
  while (i + 1 < size)
  {
    const void* const found = std::memchr(data + i, 0xFF, size - 1 - i);
    if (found == nullptr) return size;
    i = static_cast<std::size_t>(static_cast<const unsigned char*>(found) - data);
    const unsigned char next = data[i + 1];
    const bool stuffed = next == 0x00 || next == kFill;
    const bool alone = (next >= kFirstRestart && next <= kLastRestart) || next == kTemporary;
    if (!stuffed && !alone) return i;
    ++i;
  }
  return size;
}

Structure readStructure(const unsigned char* data, std::size_t size)
{
  Structure found;
  if (size < 4 || data[0] != 0xFF || data[1] != kStartOfImage) return found;
  for (std::size_t i = findMarker(data, size, 2); i + 1 < size;)
  {
    const unsigned char marker = data[i + 1];
    if (marker == kEndOfImage)
    {
      found.complete = found.first_scan != 0 && !found.info.size.empty();
      return found;
    }
    if (size - i < 4) return found;
    const std::size_t length = bigEndian<2>(data + i + 2);
    if (length < 2 || length > size - i - 2) return found;
    const std::size_t end = i + 2 + length;
    if (beginsFrame(marker) && length >= 8 && found.info.size.empty())  // libjpeg refuses a second frame
    {
      found.baseline = marker == kBaseline;
      found.info.size = {static_cast<int>(bigEndian<2>(data + i + 7)), static_cast<int>(bigEndian<2>(data + i + 5))};
      found.info.color = data[i + 9] != 1;
    }
    if (marker == kHuffmanTables) found.tables.insert(found.tables.end(), data + i, data + end);
    if (marker == kStartOfScan && found.first_scan == 0) found.first_scan = i;
    i = findMarker(data, size, end);
  }
  return found;
}

Structure readCompleteStructure(const unsigned char* data, std::size_t size)
{
  const std::string what = "JPEG of " + std::to_string(size) + " bytes ";
  Structure found = readStructure(data, size);
  if (!found.complete) throw std::invalid_argument(what + "is damaged or truncated");
  requireDecodableSize(what, static_cast<std::uint64_t>(found.info.size.width),
                       static_cast<std::uint64_t>(found.info.size.height));
  return found;
}

/// The segments with the standard Huffman tables, taken from a stream of the encoder, which uses them by default.
std::vector<std::uint8_t> makeStandardTables()
{
  std::vector<std::uint8_t> stream;
  encodeJpeg(cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(0)), /*rgb=*/false, JpegParams(), stream);
  return readStructure(stream.data(), stream.size()).tables;
}

}  // namespace

void requireDecodableSize(const std::string& what, std::uint64_t width, std::uint64_t height)
{
  if (height != 0 && width > kMaxPixels / height)
    throw std::invalid_argument(what + "claims to be of " + sizeText(width, height) + ", the most is " +
                                std::to_string(kMaxPixels) + " pixels");
}

bool isJpeg(const unsigned char* data, std::size_t size)
{
  return size > 2 && data[0] == 0xFF && data[1] == kStartOfImage;
}

bool isCompleteJpeg(const unsigned char* data, std::size_t size)
{
  return readStructure(data, size).complete;
}

cv::Size claimedJpegSize(const unsigned char* data, std::size_t size)
{
  return readStructure(data, size).info.size;
}

JpegInfo readJpegInfo(const unsigned char* data, std::size_t size)
{
  return readCompleteStructure(data, size).info;
}

JpegInfo copyJpeg(const unsigned char* data, std::size_t size, std::vector<std::uint8_t>& out)
{
  const Structure found = readCompleteStructure(data, size);
  if (!found.baseline || !found.tables.empty())
  {
    out.assign(data, data + size);
    return found.info;
  }
  static const std::vector<std::uint8_t> standard = makeStandardTables();
  out.reserve(size + standard.size());
  out.assign(data, data + found.first_scan);
  out.insert(out.end(), standard.begin(), standard.end());
  out.insert(out.end(), data + found.first_scan, data + size);
  return found.info;
}

}  // namespace robot_vision
