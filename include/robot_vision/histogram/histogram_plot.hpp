#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/histogram/histogram.hpp"

namespace robot_vision
{

struct HistogramPlotParams
{
  std::string plot = "over";
  std::string scale = "linear";

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("plot", &HistogramPlotParams::plot, OneOf{"over or beside"}, "",
          "where the curves are drawn, on the darkened lower half of the image or at its right");
    visit("scale", &HistogramPlotParams::scale, OneOf{"linear or log"}, "",
          "of the counts, log to see small ones beside a large one");
  }
};

/// Draws the curves of all channels with axes into a copy of an image (CV_8UC3, BGR), which is twice as wide if they
/// are beside it. The highest bin of all reaches the upper end of the axis. `out` is reused if it fits, and must not
/// share pixels with `bgr`. Throws std::invalid_argument as validate() does, and for an image of another type.
void plotHistogram(const cv::Mat& bgr, const std::vector<ChannelHistogram>& histogram,
                   const HistogramPlotParams& params, cv::Mat& out);

/// Shows a histogram of hueSaturationHistogram() as an image (CV_8UC3, BGR) of 360x256 px: two columns for a hue, from
/// 0 at the left, and a row for a saturation, from 0 at the bottom. Each bin has its own colour, as bright as it is
/// full. Throws std::invalid_argument as validate() does, and for what is no such histogram.
void drawHueSaturation(const cv::Mat& histogram, const HistogramPlotParams& params, cv::Mat& out);

}  // namespace robot_vision
