#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{

/// The contents of a sensor_msgs/CompressedImage. `format` is a label as compressed_image_transport writes it, for
/// instance "rgb8; jpeg compressed bgr8" for pixels that were rgb8 (JPEG and PNG always count as bgr8), and "mono8; png
/// compressed " for pixels without colour. Other publishers write only "jpeg" or "png".
struct CompressedImage
{
  std::string format;
  std::vector<std::uint8_t> data;
};

struct CompressionParams
{
  std::string format = "jpeg";
  JpegParams jpeg;
  int png_level = 9;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("format", &CompressionParams::format, OneOf{"jpeg or png", "'"}, "", "the codec, of which png loses nothing");
    visit("png_level", &CompressionParams::png_level, Range{1, 9}, "", "of PNG: 1 fast, 9 small");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const CompressionParams& params);

/// Compresses an image of one of these encodings of sensor_msgs: gray, Bayer, bgr, rgb, bgra and rgba of 8 or 16 bits,
/// 8UC1, 8UC3, 16UC1, 16UC3, yuv422 and yuv422_yuy2 (which become bgr8). Alpha is lost. JPEG reduces 16 bits to 8, and
/// the label says so. Throws std::invalid_argument for another encoding, or if `image` is not of it.
void compress(const cv::Mat& image, const std::string& encoding, const CompressionParams& params, CompressedImage& out);

struct CompressedInfo
{
  std::string format;  // jpeg or png
  cv::Size size;       // px
};

/// Reads what the bytes are, without decoding them. Throws std::invalid_argument if they are neither JPEG nor PNG, not
/// complete, without pixels, or claim more than kMaxPixels.
CompressedInfo readCompressedInfo(const unsigned char* data, std::size_t size);

/// The label of a camera's JPEG.
std::string jpegFormat(bool color);

enum class ColorMode
{
  kUnchanged,  // the encoding that the label names
  kGray,       // mono8
  kColor,      // bgr8
};

/// Decompresses into `image` (reused if it fits) and returns its encoding. `reduction` 1, 2, 4 or 8 divides both sides.
/// Throws std::invalid_argument if the data is damaged, too large, neither JPEG nor PNG, or not what `format` says.
std::string decompress(const std::string& format, const unsigned char* data, std::size_t size, ColorMode mode,
                       int reduction, cv::Mat& image);

}  // namespace robot_vision
