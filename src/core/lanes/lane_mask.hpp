#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/lanes/lane_detector.hpp"

namespace robot_vision::lanes
{

/// The pixels of a view from above that may be of a line: CV_8UC1, 0 or 255. `seen` (CV_8UC1) is what of the view the
/// camera sees; what is found at its border is left out.
cv::Mat lineMask(const cv::Mat& view, const cv::Mat& seen, double resolution, const LaneParams& params);

/// How far beside a pixel the floor is looked at, for a method that compares both: px.
int floorDistance(double resolution, const LaneParams& params);

}  // namespace robot_vision::lanes
