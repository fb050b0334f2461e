#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// How an image is shown.
struct DisplayParams
{
  std::string format = "jpeg";
  int quality = 80;
  int width = 0;
  int height = 0;
  bool turned = false;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("format", &DisplayParams::format, OneOf{"jpeg or png", "'"}, "", "the codec, of which png loses nothing");
    visit("quality", &DisplayParams::quality, Range{1, 100}, "%", "of JPEG");
    visit("width", &DisplayParams::width, Range{0, 16384}, "px", "0: that of the image");
    visit("height", &DisplayParams::height, Range{0, 16384}, "px", "0: that of the image");
    visit("turned", &DisplayParams::turned, Anything{}, "", "by half a turn");
  }
};

/// The largest distance that displayImage() tells from others, which is white.
constexpr double kWhiteDepth = 10.0;  // m

/// An image that people look at, 8 bits of one, three or four channels, and whether these are in the order of rgb8.
struct DisplayedImage
{
  cv::Mat pixels;
  bool rgb = false;
};

/// What people are shown of an image of one of these encodings: those of isMessageEncoding(), which stay as they are
/// where they have 8 bits of gray or colour; 8UC1, 8UC3 and 8UC4; bgr16, rgb16, bgra16 and rgba16; depths (16UC1 in mm,
/// 32FC1 and 64FC1 in m) and labels.
/// Depths are gray, black where there is none, else 255 * sqrt(depth / kWhiteDepth): near things differ more than far
/// ones. Labels are 8SC1, 16SC1 and 32SC1, and mono16 without a number above 255, which would be all black: 0 is black,
/// others have colours, negative ones are gray. `view` shares the input's pixels if nothing has to be changed, else it
/// is reused if it fits. Throws std::invalid_argument for another encoding, or if `image` is not of it.
void displayImage(const cv::Mat& image, const std::string& encoding, DisplayedImage& view);

/// Makes JPEGs and PNGs of images to look at. It keeps its buffers; threads must not share one.
class DisplayEncoder
{
public:
  /// Encodes what displayImage() gives, resized (by areas where it becomes smaller) and turned. Throws as
  /// displayImage() does, and std::invalid_argument naming the first parameter out of range, or the size if it has too
  /// many pixels.
  void encode(const cv::Mat& image, const std::string& encoding, const DisplayParams& params,
              std::vector<std::uint8_t>& out);

private:
  DisplayedImage display(const cv::Mat& image, const std::string& encoding, const DisplayParams& params);

  cv::Mat converted_;  // each of these has memory of its own, never that of an image that was encoded
  cv::Mat resized_;
  cv::Mat turned_;
};

}  // namespace robot_vision
