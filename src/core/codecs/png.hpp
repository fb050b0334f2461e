#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Whether the bytes begin with the signature of PNG.
bool isPng(const unsigned char* data, std::size_t size);

/// Whether a PNG has EXIF data, which may say how the image is turned.
bool hasExif(const unsigned char* data, std::size_t size);

struct PngInfo
{
  bool color = false;  // otherwise gray; gray with alpha counts as colour, because OpenCV reads it so
  bool wide = false;   // 16 bits, otherwise at most 8
};

/// Reads the kind of a PNG. Throws std::invalid_argument if the stream is no PNG, is damaged, or claims more than
/// kMaxPixels.
PngInfo readPngInfo(const unsigned char* data, std::size_t size);

/// The stream without all chunks but those of the image and EXIF. The others cost time and memory, and where OpenCV
/// decodes the stream, libpng prints what is wrong with them, most often with color profiles.
std::vector<std::uint8_t> withoutMetadata(const unsigned char* data, std::size_t size);

/// Decodes as cv::imdecode does with `flags` of cv::IMREAD_UNCHANGED, COLOR, GRAYSCALE, ANYCOLOR and ANYDEPTH, but
/// ignores the EXIF orientation, and prints nothing. Throws std::invalid_argument if the stream is no PNG, is truncated
/// or damaged, or claims more than kMaxPixels.
cv::Mat decodePng(const unsigned char* data, std::size_t size, int flags);

/// Encodes with zlib's compression `level`, 1 (fast) to 9 (small).
void encodePng(const cv::Mat& image, int level, std::vector<std::uint8_t>& out);

}  // namespace robot_vision
