#include "robot_vision/histogram/histogram.hpp"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kHues = 180.0;
constexpr double kLevels = 256.0;

struct Channel
{
  const char* name;
  double high;  // the first number that is no value
};

struct Space
{
  int conversion;  // of cv::cvtColor, from BGR; below 0: none
  std::vector<Channel> channels;
};

const std::map<std::string, Space> kSpaces = {
    {"bgr", {-1, {{"blue", kLevels}, {"green", kLevels}, {"red", kLevels}}}},
    {"hsv", {cv::COLOR_BGR2HSV, {{"hue", kHues}, {"saturation", kLevels}, {"value", kLevels}}}},
    {"lab", {cv::COLOR_BGR2Lab, {{"lightness", kLevels}, {"a", kLevels}, {"b", kLevels}}}},
    {"ycrcb", {cv::COLOR_BGR2YCrCb, {{"luma", kLevels}, {"cr", kLevels}, {"cb", kLevels}}}},
};

ChannelHistogram countChannel(const cv::Mat& pixels, int number, const Channel& channel, int bins, const cv::Mat& mask)
{
  const float range[] = {0.0F, static_cast<float>(channel.high)};
  const float* ranges[] = {range};
  cv::Mat counts, rounded;
  cv::calcHist(&pixels, 1, &number, mask, counts, 1, &bins, ranges);
  counts.convertTo(rounded, CV_32S);
  return {channel.name, 0.0, channel.high, {rounded.begin<std::int32_t>(), rounded.end<std::int32_t>()}};
}

/// The gray image, with all of its bits if there are more than 8.
cv::Mat grayPixels(const cv::Mat& image, const std::string& encoding)
{
  if (encoding == "mono16" || encoding == "mono10")
  {
    checkPixels(image, encoding);
    return image;
  }
  cv::Mat gray;
  toGray(image, encoding, gray);
  return gray;
}

double grayLevels(const std::string& encoding)
{
  if (encoding == "mono16") return 65536.0;
  return encoding == "mono10" ? 1024.0 : kLevels;
}

}  // namespace

cv::Rect partOf(const cv::Size& size, const cv::Rect& region)
{
  cv::Rect part = region;
  if (part.width == 0 && part.x >= 0) part.width = std::max(size.width - part.x, 1);
  if (part.height == 0 && part.y >= 0) part.height = std::max(size.height - part.y, 1);
  requireInside(part, size);
  return part;
}

std::vector<ChannelHistogram> computeHistogram(const cv::Mat& image, const std::string& encoding,
                                               const HistogramParams& params, const cv::Rect& region,
                                               const cv::Mat& mask)
{
  validate(params);
  const bool is_gray = params.space == "gray";
  cv::Mat pixels;
  if (is_gray)
    pixels = grayPixels(image, encoding);
  else
    toBgr(image, encoding, pixels);
  if (!mask.empty())
  {
    checkPixels(mask, "mono8");
    require(mask.size() == pixels.size(), "the mask's size", toText(mask.size()),
            "the image's, " + toText(pixels.size()));
  }
  const cv::Rect part = partOf(pixels.size(), region);
  const cv::Mat counted = mask.empty() ? cv::Mat() : mask(part);
  pixels = pixels(part);
  if (is_gray) return {countChannel(pixels, 0, {"gray", grayLevels(encoding)}, params.bins, counted)};

  const Space& space = kSpaces.at(params.space);
  cv::Mat converted;  // not the memory of `pixels`, which may be the image's
  if (space.conversion < 0)
    converted = pixels;
  else
    cv::cvtColor(pixels, converted, space.conversion);
  std::vector<ChannelHistogram> histogram;
  for (const Channel& channel : space.channels)
    histogram.push_back(countChannel(converted, static_cast<int>(histogram.size()), channel, params.bins, counted));
  return histogram;
}

}  // namespace robot_vision
