#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/tags/pose/tag_plane.hpp"

namespace robot_vision
{

/// A depth of a tag.
struct DepthSample
{
  cv::Vec3d ray;  // x, y, 1
  double inverse_depth;
  double noise;  // standard deviation of the inverse depth, 1/m
};

/// From one depth of a tag that is used to the next (px), so that some thousand are used at most.
cv::Size depthStride(const std::array<cv::Point2d, 4>& corners);

/// The depths inside of the corners of a tag (px, counter-clockwise as seen) that are known. `depth` is that of
/// measureTagPlane().
std::vector<DepthSample> depthSamples(const cv::Mat& depth, const std::array<cv::Point2d, 4>& corners,
                                      const cv::Size& stride, const CameraModel& camera,
                                      const DepthErrorParams& params);

}  // namespace robot_vision
