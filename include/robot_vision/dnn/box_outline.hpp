#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// The corners of a box that is turned, clockwise in an image.
using BoxOutline = std::array<cv::Point2d, 4>;

/// The area of a box.
double areaOf(const BoxOutline& box);

/// The area that two boxes both cover.
double sharedArea(const BoxOutline& a, const BoxOutline& b);

}  // namespace robot_vision
