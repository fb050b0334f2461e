#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>

#include "compressed_image.hpp"
#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct DepthCompressionParams
{
  std::string format = "png";
  double depth_max = 10.0;
  double depth_quantization = 100.0;
  int png_level = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("format", &DepthCompressionParams::format, OneOf{"png or rvl", "'"}, "",
          "the codec, of which rvl takes less work");
    visit("depth_max", &DepthCompressionParams::depth_max, Range{1, 100}, "m", "what is farther is lost");
    visit("depth_quantization", &DepthCompressionParams::depth_quantization, Range{1, 150}, "m",
          "of 32FC1: where its steps are 1 m; nearer they are finer");
    visit("png_level", &DepthCompressionParams::png_level, Range{1, 9}, "", "of PNG: 1 fast, 9 small");
  }
};

/// Whether images of this encoding hold depths: 16UC1 and mono16 in mm, 32FC1 in m.
bool isDepth(const std::string& encoding);

/// Compresses a depth image as compressed_depth_image_transport does: a header of 12 bytes, then a 16-bit PNG, or RVL,
/// of the millimetres, or of the inverse depth for 32FC1. Pixels without a depth (0, NaN, infinite or negative) stay
/// without one; in 32FC1, a depth nearer than the code can express (0.15 m by default) becomes the nearest one that it
/// can. Throws std::invalid_argument for another encoding, or if `image` is not of it.
void compressDepth(const cv::Mat& image, const std::string& encoding, const DepthCompressionParams& params,
                   CompressedImage& out);

/// Decompresses into `image`, and returns its encoding. Pixels without a depth are 0 in 16 bits and NaN in 32FC1.
/// `format` is the label of the message, which tells PNG from RVL. Throws std::invalid_argument if the data is damaged,
/// too large or not what `format` says.
std::string decompressDepth(const std::string& format, const unsigned char* data, std::size_t size, cv::Mat& image);

}  // namespace robot_vision
