#include "color_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr int kBlocks = 10;            // along the longer side of a region
constexpr double kMinFilled = 0.3;     // share of a block's pixels that are compared
constexpr double kDark = 24.0;         // mean of the channels: darker ones have no color
constexpr int kMinBlocks = 4;          // that tell something
constexpr double kMinContrast = 0.08;  // standard deviation of the brightness drawn, as share of its mean
const double kNan = std::numeric_limits<double>::quiet_NaN();

/// Correlation of two numbers.
struct Correlation
{
  double n = 0, a = 0, b = 0, aa = 0, ab = 0, bb = 0;

  void add(double first, double second)
  {
    n += 1.0;
    a += first;
    b += second;
    aa += first * first;
    ab += first * second;
    bb += second * second;
  }

  double value() const
  {
    const double spread = aa / n - a * a / (n * n), other = bb / n - b * b / (n * n);
    const double contrast = kMinContrast * a / n;
    if (n < kMinBlocks || !(spread > contrast * contrast)) return kNan;
    return other > 0.0 ? (ab / n - a * b / (n * n)) / std::sqrt(spread * other) : 0.0;
  }
};

/// The sums of the colors of a block, as drawn and as seen.
struct BlockColors
{
  cv::Vec3d drawn, seen;
  int pixels = 0;
};

BlockColors colorsOf(const RenderedRegion& region, const cv::Mat& bgr, const cv::Mat& explained, const cv::Rect& block)
{
  BlockColors colors;
  for (int y = block.y; y < block.br().y; ++y)
    for (int x = block.x; x < block.br().x; ++x)
    {
      if (explained.at<std::uint8_t>(y, x) == 0) continue;
      colors.drawn += region.view.bgr.at<cv::Vec3b>(y, x);
      colors.seen += bgr.at<cv::Vec3b>(region.inImage(x, y));
      ++colors.pixels;
    }
  return colors;
}

double mean(const cv::Vec3d& color)
{
  return (color[0] + color[1] + color[2]) / 3.0;
}

}  // namespace

void compareColors(const RenderedRegion& region, const RecognitionFrame& frame, const cv::Mat& explained,
                   double max_hue_error, PoseEvidence& evidence)
{
  const int side = std::max(2, (std::max(explained.cols, explained.rows) + kBlocks - 1) / kBlocks);
  const double min_cosine = std::cos(max_hue_error * CV_PI / 180.0);
  Correlation brightness;
  int all = 0, alike = 0;
  for (int y = 0; y < explained.rows; y += side)
    for (int x = 0; x < explained.cols; x += side)
    {
      const cv::Rect block(x, y, std::min(side, explained.cols - x), std::min(side, explained.rows - y));
      const BlockColors colors = colorsOf(region, frame.bgr(), explained, block);
      if (colors.pixels < kMinFilled * side * side) continue;
      brightness.add(mean(colors.drawn) / colors.pixels, mean(colors.seen) / colors.pixels);
      if (std::min(mean(colors.drawn), mean(colors.seen)) < kDark * colors.pixels) continue;
      ++all;
      const double lengths = cv::norm(colors.drawn) * cv::norm(colors.seen);
      alike += colors.drawn.dot(colors.seen) >= min_cosine * lengths ? 1 : 0;
    }
  evidence.colors = all >= kMinBlocks ? static_cast<double>(alike) / all : kNan;
  evidence.pattern = brightness.value();
}

}  // namespace robot_vision
