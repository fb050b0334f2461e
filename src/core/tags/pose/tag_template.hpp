#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "blurred_grid.hpp"

namespace robot_vision
{

/// The square cells of a tag.
struct TagTemplate
{
  cv::Mat cells;   // as BlurredGrid takes them
  int margin = 0;  // cells on each side that lie outside of the corners to be found

  int widthAtBorder() const { return cells.cols - 2 * margin; }
};

/// A point that a homography has mapped, and the derivative by the original point.
struct Mapped
{
  cv::Point2d point;
  cv::Matx22d jacobian;
};

Mapped mapped(const cv::Matx33d& H, const cv::Point2d& point);

/// The homography from positions in the undistorted image (px) to a template: x and y from its middle, in its widths,
/// -0.5 to 0.5. `corners` (px) are in TagCorners' order.
cv::Matx33d toTemplate(const std::array<cv::Point2d, 4>& corners, const TagTemplate& tag_template);

/// The corners in the image for such a homography, the inverse of toTemplate().
std::array<cv::Point2d, 4> templateCorners(const cv::Matx33d& to_template, const TagTemplate& tag_template);

// The unknowns of a view: eight of the homography, the sigma of the blur (px), the gray level of black and the
// contrast of white above it, each with its slopes along x and y of the template, and the gray level around the
// template above that of black.
constexpr int kBlur = 8, kBlack = 9, kContrast = 12, kAround = 15, kUnknowns = 16;
using Unknowns = cv::Vec<double, kUnknowns>;

/// What determines the image of a template.
struct TagView
{
  cv::Matx33d H;        // toTemplate()
  Unknowns appearance;  // the unknowns from kBlur on
};

/// Changes the unknowns of a view. To first order, a point q of the template moves by a + B q + q (c q).
TagView movedView(const TagView& view, const Unknowns& by);

/// The gray level of a view at a position in the undistorted image, with its derivatives by the unknowns. `width` is
/// that of the cells.
double grayAt(const BlurredGrid& cells, int width, const TagView& view, const cv::Point2d& position,
              Unknowns& jacobian);

/// The derivatives of the corners, x and y, by the eight unknowns of the homography.
cv::Matx<double, 8, 8> cornersByHomography(const cv::Matx33d& H, const std::array<cv::Point2d, 4>& corners);

}  // namespace robot_vision
