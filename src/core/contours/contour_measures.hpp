#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/contours/contours.hpp"

namespace robot_vision
{

/// A contour of this outline, which has a point, with all that its points alone tell, its name included. `epsilon` and
/// `min_defect` of the parameters count.
Contour measureContour(const std::vector<cv::Point>& outline, const ContourParams& params);

}  // namespace robot_vision
