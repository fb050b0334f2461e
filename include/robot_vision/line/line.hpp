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

/// A line to follow. Pixel centres have integer coordinates, so that the middle of an image of width w is (w - 1) / 2.
/// If no line was found, all fields are zero or empty.
struct Line
{
  bool found = false;
  double offset = 0.0;             // px, x of the line's centroid relative to the middle of the image, > 0 to the right
  double error = 0.0;              // offset in half image widths, -1 (left border) to 1
  double angle = 0.0;              // rad, direction of the line in the image, -pi/2 to pi/2: 0 straight up, right > 0
  double confidence = 0.0;         // 0 to 1, see findLine()
  double area = 0.0;               // px^2, pixels of the line without holes
  cv::Point2d center;              // px, centroid of the line
  std::vector<cv::Point> outline;  // px, outer border, corners only
};

/// Finds the line in a mask (CV_8UC1, not 0 on the line) of the part of the image in which it is searched for.
///
/// The line is the largest 8-connected region; smaller regions beside it have no effect. If `previous` was found, the
/// area of a region counts less the further its centroid is to the left or right of the previous one: a half at an
/// eighth of the width, a 17th at half of the width.
///
/// The angle is that of a straight line, fitted by least squares to the middles of the region's rows, weighted by their
/// numbers of pixels. If more of the region's columns than of its rows are whole, because the line runs from side to
/// side, their middles are used instead. Rows and columns that the border of the mask may have cut are ignored.
///
/// The confidence is the product of four factors: the region's share of the mask's white pixels; the share of its rows
/// (or columns) with both ends in view; area / (area + min_area); and 1 / (1 + (residual / width)^2), where the
/// residual is the root mean square of the fit and the width the mean length of the rows. It is 0 for a region that
/// fills more than three quarters of the mask, which is the floor.
///
/// Throws std::invalid_argument as validate() does, or if `mask` is empty or of another type.
Line findLine(const cv::Mat& mask, const LineParams& params = LineParams(), const Line& previous = Line());

}  // namespace robot_vision
