#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// Whether the bytes begin as a JPEG stream.
bool isJpeg(const unsigned char* data, std::size_t size);

/// True if the bytes are a JPEG stream with a picture, from its start-of-image to its end-of-image marker (ITU-T T.81,
/// annex B). Decoders that fill the missing part of a truncated stream with gray do not tell.
bool isCompleteJpeg(const unsigned char* data, std::size_t size);

/// 8192 x 8192: a stream of some hundred bytes can claim to be a picture that fills the memory.
constexpr std::size_t kMaxPixels = std::size_t{1} << 26;
constexpr int kLongestJpegSide = 65500;  // px, libjpeg's own limit

struct JpegInfo
{
  cv::Size size;       // px
  bool color = false;  // else gray
};

/// What the stream's first frame claims to be of, whole or not; empty if there is none.
cv::Size claimedJpegSize(const unsigned char* data, std::size_t size);

/// Throws std::invalid_argument if the stream is not complete or has more than kMaxPixels.
JpegInfo readJpegInfo(const unsigned char* data, std::size_t size);

/// Writes the stream into `out`, byte for byte. Only where a baseline stream has no Huffman tables, as some cameras'
/// Motion JPEG, the standard ones (T.81, K.3) are put in: not every reader knows that they are meant.
/// Throws as readJpegInfo does; it costs the reading of the markers, not of the pixels.
JpegInfo copyJpeg(const unsigned char* data, std::size_t size, std::vector<std::uint8_t>& out);

enum class JpegPixels
{
  kBgr,
  kRgb,
  kGray,  // the luma alone, which spares the work on the chroma
};

/// Throws std::invalid_argument unless `reduction` is 1, 2, 4 or 8.
void validateReduction(int reduction);

/// Decodes into `out` (CV_8UC3 or CV_8UC1, reused if it fits), as cv::imdecode does, but never turned by EXIF.
/// `reduction` 1, 2, 4 or 8 gives 1/n of the size, rounded up, for much less work.
/// What cameras write beside a whole picture is no damage: bytes in front of the first scan, padding or a few bytes
/// in front of a later marker, odd versions, no Huffman tables. Pixels have no checksum: damage that still decodes, and
/// leaves no more than those few bytes over, cannot be noticed. Throws std::invalid_argument if the stream is
/// truncated, damaged, too large or of more scans than any picture needs.
void decodeJpeg(const unsigned char* data, std::size_t size, JpegPixels pixels, cv::Mat& out, int reduction = 1);

/// Throws as decodeJpeg does, whatever the stream's colours are, CMYK too: for decoders that print what is wrong.
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

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const JpegParams& params);

/// Encodes mono8 (CV_8UC1), bgr8 (CV_8UC3) or bgra8 (CV_8UC4), with `rgb` rgb8 or rgba8, into `out`, with chroma of
/// half the resolution, as cv::imencode does. Throws std::invalid_argument for pictures of another type or size.
void encodeJpeg(const cv::Mat& image, bool rgb, const JpegParams& params, std::vector<std::uint8_t>& out);

}  // namespace robot_vision
