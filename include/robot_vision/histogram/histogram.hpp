#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct HistogramParams
{
  std::string space = "bgr";
  int bins = 64;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("space", &HistogramParams::space, OneOf{"gray, bgr, hsv, lab or ycrcb"}, "",
          "whose channels are counted, each by itself");
    visit("bins", &HistogramParams::bins, Range{1, 1024}, "", "of each channel, all of the same width");
  }
};

/// How many pixels have which value of one channel.
struct ChannelHistogram
{
  std::string name;                  // gray; blue, green, red; hue, saturation, value; lightness, a, b; luma, cr, cb
  double low = 0.0;                  // where the first bin begins
  double high = 0.0;                 // where the last bin ends; no pixel has this value
  std::vector<std::int32_t> counts;  // px, the pixels in each bin
};

/// The part of an image of `size` that a region (px) means: a width or height of 0 reaches to the border. Throws
/// std::invalid_argument naming both if it is not inside of the image.
cv::Rect partOf(const cv::Size& size, const cv::Rect& region);

/// Counts the values of each channel, as cv::calcHist does, in a region of the image (see partOf()) where the mask
/// (CV_8UC1, of the image's size) is not 0; without a mask everywhere. Values are those of cv::cvtColor with 8 bits:
/// 0 to 255, hues 0 to 179. The gray of mono16 and mono10 has all of its bits: 0 to 65535 and 0 to 1023. A count above
/// 2^24 is rounded as a float is. `image` is not modified. Throws std::invalid_argument as validate() does, if `image`
/// is not an image of `encoding` (see encoding.hpp), for a mask that does not fit, and as partOf() does.
std::vector<ChannelHistogram> computeHistogram(const cv::Mat& image, const std::string& encoding,
                                               const HistogramParams& params = HistogramParams(),
                                               const cv::Rect& region = cv::Rect(), const cv::Mat& mask = cv::Mat());

}  // namespace robot_vision
