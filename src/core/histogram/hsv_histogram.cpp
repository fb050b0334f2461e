#include "hsv_histogram.hpp"

#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

const float kHues[] = {0.0F, 180.0F};
const float kSaturations[] = {0.0F, 256.0F};
const float* const kRanges[] = {kHues, kSaturations};
const int kChannels[] = {0, 1};

}  // namespace

HsvPixels::HsvPixels(const cv::Mat& bgr, int min_saturation, int min_value)
{
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  if (min_saturation > 0 || min_value > 0)
    cv::inRange(hsv, cv::Scalar(0, min_saturation, min_value), cv::Scalar::all(255), mask);
}

HsvPixels HsvPixels::operator()(const cv::Rect& part) const
{
  HsvPixels pixels;
  pixels.hsv = hsv(part);
  if (!mask.empty()) pixels.mask = mask(part);
  return pixels;
}

cv::Mat HsvPixels::histogram(int hue_bins, int saturation_bins) const
{
  const int bins[] = {hue_bins, saturation_bins};
  const float* ranges[] = {kRanges[0], kRanges[1]};
  cv::Mat counts;
  cv::calcHist(&hsv, 1, kChannels, mask, counts, 2, bins, ranges);
  return counts;
}

void HsvPixels::backProject(const cv::Mat& histogram, cv::Mat& out) const
{
  // Of a histogram whose bins are all equal NORM_MINMAX would make an empty one.
  cv::Mat relative;
  cv::normalize(histogram, relative, 255.0, 0.0, cv::NORM_INF);
  const float* ranges[] = {kRanges[0], kRanges[1]};
  cv::calcBackProject(&hsv, 1, kChannels, relative, out, ranges);
  if (!mask.empty()) cv::bitwise_and(out, mask, out);
}

}  // namespace robot_vision
