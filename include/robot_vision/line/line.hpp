#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct LineParams
{
  double min_area = 100.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("min_area", &LineParams::min_area, Range{1, 1e9}, "px^2", "smallest region that is taken for a line");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const LineParams& params);

/// A line to follow. Pixel centres have integer coordinates, so the middle of a picture of width w is at (w - 1) / 2.
/// Where nothing was found, all is zero and empty.
struct Line
{
  bool found = false;
  double offset = 0.0;             // px, centroid of the line right of the middle of the picture
  double error = 0.0;              // offset in half picture widths, -1 (left border) to 1
  double angle = 0.0;              // rad, direction of the line in the picture, -pi/2 to pi/2: 0 straight up, right > 0
  double confidence = 0.0;         // 0 to 1, see findLine()
  double area = 0.0;               // px^2, pixels of the line, holes left out
  cv::Point2d center;              // px, centroid of the line
  std::vector<cv::Point> outline;  // px, outer border, corners only
};

/// Finds the line in a mask (CV_8UC1, not 0 on the line) of the part of the picture where it is looked for.
///
/// The line is the largest 8-connected region; speckles beside it count for nothing. If `previous` was found, a region
/// counts the less the further its centroid lies left or right of it: half at an eighth of the width, a 17th at half.
///
/// The angle is that of a straight line fitted by least squares to the middles of the region's rows, each weighted
/// with its pixels, or to those of its columns where more of these are whole: for a line that runs from side to side.
/// Those that the border of the mask may have cut are left out.
///
/// The confidence is the product of four shares: of the mask's pixels those in the region; of its rows (or columns)
/// those with both ends in view; area / (area + min_area); and 1 / (1 + (residual / width)^2) with the fit's root mean
/// square residual and the mean length of the rows. A mask that is all line shows none: its confidence is 0.
///
/// Throws std::invalid_argument as validate() does, or if `mask` is empty or of another type.
Line findLine(const cv::Mat& mask, const LineParams& params = LineParams(), const Line& previous = Line());

}  // namespace robot_vision
