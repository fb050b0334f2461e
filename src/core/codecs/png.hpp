#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// True if the bytes begin as every PNG does.
bool isPng(const unsigned char* data, std::size_t size);

struct PngInfo
{
  bool color = false;  // else gray; gray with alpha counts as colour, as OpenCV reads it
  bool wide = false;   // 16 bits, else at most 8
};

/// Throws std::invalid_argument if it is damaged, or of more pixels than fit into memory beside others.
PngInfo readPngInfo(const unsigned char* data, std::size_t size);

/// The stream with only that in it which the image is made of, and EXIF: libpng prints what it finds wrong with the
/// rest, color profiles above all, on the terminal, and OpenCV lets it.
std::vector<std::uint8_t> withoutNotes(const unsigned char* data, std::size_t size);

/// Decodes with cv::imdecode's `flags`. Throws std::invalid_argument if the stream is no PNG, truncated, damaged or of
/// more pixels than fit into memory beside others.
cv::Mat decodePng(const unsigned char* data, std::size_t size, int flags);

/// `level` is zlib's, 1 (fast) to 9 (small).
void encodePng(const cv::Mat& image, int level, std::vector<std::uint8_t>& out);

}  // namespace robot_vision
