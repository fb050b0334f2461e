#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "tag_pose.hpp"

namespace robot_vision
{

/// Refines the corners of a tag, starting near where they were found, and computes their covariance. The tag's cells,
/// blurred and seen through the lens, are fitted to the image: the edges of all cells contribute, and the remaining
/// differences tell how far the corners can be trusted. `gray` is CV_8UC1, `cells` comes from tagCells() and
/// `width_at_border` from the TagFamily. The result is empty if the image does not look like this tag near there (it is
/// covered or cut off), if the camera has no rays there, and if a corner is so uncertain that estimatePose() would
/// refuse the covariance.
std::optional<TagCorners> measureCorners(const cv::Mat& gray, const cv::Mat& cells, int width_at_border,
                                         const TagCorners& near, const CameraModel& camera);

}  // namespace robot_vision
