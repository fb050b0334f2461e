#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "blurred_grid.hpp"

namespace robot_vision
{

/// Square cells, and how many of them lie on each side outside of the corners that are looked for.
struct Pattern
{
  cv::Mat cells;  // as BlurredGrid has them
  int margin = 0;

  int widthAtBorder() const { return cells.cols - 2 * margin; }
};

/// A point as a homography maps it, and the derivative.
struct Mapped
{
  cv::Point2d point;
  cv::Matx22d jacobian;
};

Mapped mapped(const cv::Matx33d& H, const cv::Point2d& point);

/// The homography that takes places in the picture to a pattern: columns and rows from its middle, in its widths, -0.5
/// to 0.5. `corners`: px, TagCorners' order.
cv::Matx33d toPattern(const std::array<cv::Point2d, 4>& corners, const Pattern& pattern);

/// The other way.
std::array<cv::Point2d, 4> patternCorners(const cv::Matx33d& to_pattern, const Pattern& pattern);

// What a view may differ in: the eight of a homography, the sigma of the blur (px), the gray level of black and what
// white is above it, each with its slopes along the pattern, and what lies around it above black.
constexpr int kBlur = 8, kBlack = 9, kContrast = 12, kAround = 15, kUnknowns = 16;
using Unknowns = cv::Vec<double, kUnknowns>;

/// How a picture of a pattern comes about.
struct View
{
  cv::Matx33d H;   // toPattern()
  Unknowns looks;  // from kBlur on
};

/// A view whose pattern is moved by the unknowns: to first order q by a + B q + q (c q).
View movedView(const View& view, const Unknowns& by);

/// The gray level that a view has at a place in the picture, and how it changes with the unknowns.
double levelAt(const BlurredGrid& cells, int width, const View& view, const cv::Point2d& place, Unknowns& jacobian);

/// The corners, x and y, by the unknowns of the homography.
cv::Matx<double, 8, 8> cornersByHomography(const cv::Matx33d& H, const std::array<cv::Point2d, 4>& corners);

}  // namespace robot_vision
