#include "png.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

#include "core/common/big_endian.hpp"
#include "opencv_codecs.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr std::array<unsigned char, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kChunkOverhead = 12;  // bytes of a chunk's length, name and checksum

[[noreturn]] void refuse(std::size_t size, const std::string& reason)
{
  throw std::invalid_argument("PNG of " + std::to_string(size) + " bytes " + reason);
}

bool isPartOfTheImage(const unsigned char* name)
{
  constexpr std::array<const char*, 6> kChunkNames = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND", "eXIf"};
  return std::any_of(kChunkNames.begin(), kChunkNames.end(),
                     [name](const char* part) { return std::memcmp(name, part, 4) == 0; });
}

/// Whether the chunks follow each other up to one of this name.
bool hasChunk(const unsigned char* data, std::size_t size, const char* name)
{
  std::size_t i = kSignature.size();
  while (size - i >= kChunkOverhead)
  {
    const std::size_t length = bigEndian<4>(data + i);
    if (length > size - i - kChunkOverhead) return false;
    if (std::memcmp(data + i + 4, name, 4) == 0) return true;
    i += kChunkOverhead + length;
  }
  return false;
}

}  // namespace

bool isPng(const unsigned char* data, std::size_t size)
{
  return size >= kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), data);
}

bool hasExif(const unsigned char* data, std::size_t size)
{
  return isPng(data, size) && hasChunk(data, size, "eXIf");
}

PngInfo readPngInfo(const unsigned char* data, std::size_t size)
{
  if (!isPng(data, size)) refuse(size, "does not begin as a PNG");
  constexpr std::size_t kSizeOffset = kSignature.size() + 8;  // after the length and the name of the first chunk
  if (size < kSizeOffset + 10 || std::memcmp(data + kSizeOffset - 4, "IHDR", 4) != 0 || !hasChunk(data, size, "IEND"))
    refuse(size, "is damaged or truncated");
  requireDecodableSize("PNG of " + std::to_string(size) + " bytes ", bigEndian<4>(data + kSizeOffset),
                       bigEndian<4>(data + kSizeOffset + 4));
  constexpr unsigned char kColor = 2;  // a bit of the color type, as is the next one
  constexpr unsigned char kAlpha = 4;
  return {(data[kSizeOffset + 9] & (kColor | kAlpha)) != 0, data[kSizeOffset + 8] == 16};
}

std::vector<std::uint8_t> withoutMetadata(const unsigned char* data, std::size_t size)
{
  std::vector<std::uint8_t> kept;
  kept.reserve(size);
  std::size_t i = std::min(size, kSignature.size());
  kept.assign(data, data + i);
  while (size - i >= kChunkOverhead)
  {
    const std::size_t length = bigEndian<4>(data + i);
    if (length > size - i - kChunkOverhead) break;
    const std::size_t end = i + kChunkOverhead + length;
    if (isPartOfTheImage(data + i + 4)) kept.insert(kept.end(), data + i, data + end);
    i = end;
  }
  kept.insert(kept.end(), data + i, data + size);  // the rest of a damaged stream, so that the decoder refuses it
  return kept;
}

void encodePng(const cv::Mat& image, int level, std::vector<std::uint8_t>& out)
{
  encodeByOpenCv(".png", image, {cv::IMWRITE_PNG_COMPRESSION, level}, out);
}

}  // namespace robot_vision
