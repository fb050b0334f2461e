#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// Whether the bytes begin as a JPEG stream does.
bool isJpeg(const unsigned char* data, std::size_t size);

/// Whether the bytes are a JPEG stream with pixels, complete from its start-of-image to its end-of-image marker (ITU-T
/// T.81, annex B). Decoders do not tell: they fill the missing part of a truncated stream with gray.
bool isCompleteJpeg(const unsigned char* data, std::size_t size);

/// The largest image that is decoded, 8192 x 8192: a stream of some hundred bytes can claim a size that would fill the
/// memory.
constexpr std::size_t kMaxPixels = std::size_t{1} << 26;

/// Throws std::invalid_argument, whose message begins with `what`, if this size (px) has more than kMaxPixels.
void requireDecodableSize(const std::string& what, std::uint64_t width, std::uint64_t height);

constexpr int kLongestJpegSide = 65500;  // px, libjpeg's own limit

struct JpegInfo
{
  cv::Size size;       // px
  bool color = false;  // otherwise gray
};

/// The size in px that the stream's first frame header claims, even if the stream is not complete. Empty if there is no
/// frame header.
cv::Size claimedJpegSize(const unsigned char* data, std::size_t size);

/// Reads the size and the kind of a stream. Throws std::invalid_argument if the stream is not complete, or claims more
/// than kMaxPixels.
JpegInfo readJpegInfo(const unsigned char* data, std::size_t size);

/// Copies the stream into `out`. A baseline stream without Huffman tables, such as the Motion JPEG of some cameras,
/// gets the standard ones (T.81, K.3), because not every reader assumes them; all other streams are copied byte for
/// byte. Only the markers are read, not the pixels. Throws as readJpegInfo() does.
JpegInfo copyJpeg(const unsigned char* data, std::size_t size, std::vector<std::uint8_t>& out);

enum class JpegPixels
{
  kBgr,
  kRgb,
  kGray,  // only the luma, which saves the work for the chroma
};

/// Throws std::invalid_argument unless `reduction` is 1, 2, 4 or 8.
void validateReduction(int reduction);

/// Decodes into `out` (CV_8UC3 or CV_8UC1, reused if it fits) as cv::imdecode does, but ignores the EXIF orientation.
/// `reduction` 1, 2, 4 or 8 divides both sides (rounded up), which takes much less work.
/// Some things that cameras write around the pixels do not count as damage: bytes in front of the first scan, padding
/// or a few bytes in front of a later marker, odd versions, missing Huffman tables. As pixels have no checksum, damage
/// that still decodes and leaves no more than those few bytes over goes unnoticed. Throws std::invalid_argument if the
/// stream is truncated, damaged, too large, or has more scans than any image needs.
void decodeJpeg(const unsigned char* data, std::size_t size, JpegPixels pixels, cv::Mat& out, int reduction = 1);

/// Throws as decodeJpeg() does if something is wrong with a stream of any colour space, CMYK included. To be called
/// before decoders that would print what is wrong instead of reporting it.
void requireSoundJpeg(const unsigned char* data, std::size_t size);

struct JpegParams
{
  int quality = 80;
  bool progressive = false;
  bool optimize = false;
  int restart_interval = 0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("jpeg_quality", &JpegParams::quality, Range{1, 100}, "%", "of JPEG");
    visit("jpeg_progressive", &JpegParams::progressive, Anything{}, "", "JPEG: a rough image first");
    visit("jpeg_optimize", &JpegParams::optimize, Anything{}, "",
          "JPEG: tables made for the image, smaller and slower");
    visit("jpeg_restart_interval", &JpegParams::restart_interval, Range{0, 65535}, "blocks",
          "JPEG: between marks that a damaged image can be read on from; 0: none");
  }
};

/// Encodes mono8 (CV_8UC1), bgr8 (CV_8UC3) or bgra8 (CV_8UC4) into `out`, with the chroma at half the resolution as
/// cv::imencode does. If `rgb`, the channels are in the order of rgb8 or rgba8. Throws std::invalid_argument for an
/// image of another type, without pixels, or that is too large.
void encodeJpeg(const cv::Mat& image, bool rgb, const JpegParams& params, std::vector<std::uint8_t>& out);

}  // namespace robot_vision
