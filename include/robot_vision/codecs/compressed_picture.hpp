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

/// A picture as sensor_msgs/CompressedImage carries it, in the words of compressed_image_transport: `format` is
/// "rgb8; jpeg compressed bgr8" for pixels that were rgb8 and are stored as every JPEG's and PNG's, "mono8; png
/// compressed " for those that have no colours. Others write no more than "jpeg" or "png".
struct CompressedPicture
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

/// Compresses a picture of an encoding of sensor_msgs: gray, Bayer, bgr, rgb, bgra and rgba of 8 or 16 bits, 8UC1,
/// 8UC3, 16UC1, yuv422 and yuv422_yuy2 (as bgr8). Alpha is lost; JPEG has 8 bits, and the label says so. Throws
/// std::invalid_argument for another encoding, or pixels that are not of it.
void compress(const cv::Mat& image, const std::string& encoding, const CompressionParams& params,
              CompressedPicture& out);

/// The label of a JPEG as cameras make them.
std::string jpegFormat(bool color);

enum class ColorMode
{
  kUnchanged,  // the pixels that were compressed
  kGray,       // mono8
  kColor,      // bgr8
};

/// Decompresses into `image` (reused if it fits) and returns its encoding. `reduction` 1, 2, 4 or 8 gives 1/n of the
/// size. Throws std::invalid_argument if the data is damaged, too large, neither JPEG nor PNG or not what `format`
/// says.
std::string decompress(const std::string& format, const unsigned char* data, std::size_t size, ColorMode mode,
                       int reduction, cv::Mat& image);

}  // namespace robot_vision
