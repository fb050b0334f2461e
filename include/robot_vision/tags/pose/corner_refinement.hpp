#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "tag_pose.hpp"

namespace robot_vision
{

/// Where the corners of a tag are, near where they were found, with their covariance: where its cells, through the lens
/// and out of focus, look most like the picture. All edges of all cells take part, and what remains unlike tells how
/// far the corners can be trusted. `gray`: CV_8UC1; `cells`: of tagCells(); `width_at_border`: of its TagFamily.
/// Nothing is returned where the picture does not look like this tag near there: covered, cut off, or where the camera
/// has no rays; nor where it leaves a corner so open that the covariance is none that estimatePose() takes.
std::optional<TagCorners> measureCorners(const cv::Mat& gray, const cv::Mat& cells, int width_at_border,
                                         const TagCorners& near, const CameraModel& camera);

}  // namespace robot_vision
