#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct BrightnessParams
{
  double gain = 1.0;
  double offset = 50.0;
  double gamma = 1.0;
  int threads = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("gain", &BrightnessParams::gain, Range{0, 10}, "", "contrast: factor on every value");
    visit("offset", &BrightnessParams::offset, Range{-255, 255}, "gray levels",
          "brightness: added after the gain; white is 255");
    visit("gamma", &BrightnessParams::gamma, Range{0.1, 10}, "",
          "exponent of the last step; below 1 lifts the shadows");
    visit("threads", &BrightnessParams::threads, Range{1, 64}, "",
          "number of threads that share an image, as far as OpenCV's setting allows");
  }
};

/// Applies gain, offset and gamma: out = max * (clip(gain * in + offset) / max) ^ gamma. max is 255, or 65535 for 16
/// bits, where the offset is multiplied by 257. The result equals cv::Mat::convertTo followed by cv::LUT with the gamma
/// curve, to the bit. The lookup tables are computed once, so that each frame takes a single pass.
class Brightness
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit Brightness(const BrightnessParams& params = BrightnessParams());

  /// Writes the result, which is of outputEncoding(encoding), into `out` (reused if it fits). `image` is not modified;
  /// an alpha channel is kept. Throws std::invalid_argument if `image` is not of `encoding` (see encoding.hpp).
  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& out);

  /// The encoding of what apply() writes: the input's own for bgr8, rgb8, bgra8, rgba8, mono8 and mono16, else bgr8.
  static std::string outputEncoding(const std::string& encoding);

private:
  void applyTo(const cv::Mat& image, const cv::Range& rows, cv::Mat& out) const;

  BrightnessParams params_;
  cv::Mat table_;         // 1x256 CV_8UC1
  bool is_line_ = false;  // whether the table is a gain and an offset without gamma, which need no table
  cv::Mat alpha_table_;   // 1x256 CV_8UC4, which leaves the fourth channel unchanged
  cv::Mat wide_table_;    // 1x65536 CV_16UC1, made for the first mono16 image
  cv::Mat bgr_;
};

}  // namespace robot_vision
