#include "gray_weights.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

// The weights of ITU-R BT.601 with 15 bits, and with 14 bits as in older versions of OpenCV.
constexpr std::array<GrayWeights, 2> kKnownWeights = {{{{3735, 19235, 9798}, 15}, {{1868, 9617, 4899}, 14}}};

std::uint8_t mean(const cv::Vec3b& bgr, const GrayWeights& weights)
{
  int sum = 1 << (weights.shift - 1);
  for (int i = 0; i < 3; ++i)
    sum += bgr[i] * weights.channels[i];
  return static_cast<std::uint8_t>(sum >> weights.shift);
}

/// Tries the known weights on random colours, and on all values of each channel beside black and beside white. The rows
/// have an odd length, so that vectorized code also handles a remainder.
const GrayWeights* findWeights()
{
  cv::Mat colors(256, 271, CV_8UC3);
  cv::RNG().fill(colors, cv::RNG::UNIFORM, 0, 256);
  for (int i = 0; i < 256; ++i)
    for (int channel = 0; channel < 3; ++channel)
    {
      auto& beside_black = colors.at<cv::Vec3b>(i, channel) = cv::Vec3b(0, 0, 0);
      auto& beside_white = colors.at<cv::Vec3b>(i, 3 + channel) = cv::Vec3b(255, 255, 255);
      beside_black[channel] = beside_white[channel] = static_cast<std::uint8_t>(i);
    }
  std::array<cv::Mat, 4> grays;
  cv::Mat rgb, bgra, rgba;
  cv::cvtColor(colors, rgb, cv::COLOR_BGR2RGB);
  cv::cvtColor(colors, bgra, cv::COLOR_BGR2BGRA);
  cv::cvtColor(colors, rgba, cv::COLOR_BGR2RGBA);
  cv::cvtColor(colors, grays[0], cv::COLOR_BGR2GRAY);
  cv::cvtColor(rgb, grays[1], cv::COLOR_RGB2GRAY);
  cv::cvtColor(bgra, grays[2], cv::COLOR_BGRA2GRAY);
  cv::cvtColor(rgba, grays[3], cv::COLOR_RGBA2GRAY);
  const auto gives_all_grays = [&](const GrayWeights& weights)
  {
    cv::Mat_<std::uint8_t> expected(colors.size());
    std::transform(colors.begin<cv::Vec3b>(), colors.end<cv::Vec3b>(), expected.begin(),
                   [&](const cv::Vec3b& bgr) { return mean(bgr, weights); });
    return std::all_of(grays.begin(), grays.end(),
                       [&](const cv::Mat& gray) { return cv::norm(gray, expected, cv::NORM_INF) == 0.0; });
  };
  const auto* found = std::find_if(kKnownWeights.begin(), kKnownWeights.end(), gives_all_grays);
  return found == kKnownWeights.end() ? nullptr : found;
}

}  // namespace

const GrayWeights* grayWeightsOfBgr()
{
  static const GrayWeights* const weights = findWeights();
  return weights;
}

}  // namespace robot_vision
