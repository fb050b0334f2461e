#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "flow_image.hpp"
#include "robot_vision/features/keypoint_matching.hpp"

namespace robot_vision
{

/// Follows the keypoints of one frame into the next one by their optical flow.
class KeypointFlow
{
public:
  explicit KeypointFlow(const FlowParams& params) : params_(params) {}

  /// Adds the newest frame, CV_8UC1, which is copied.
  void add(const cv::Mat& gray);

  /// Where keypoints of the frame before are in the newest one, which must have the same size: those that are inside of
  /// it, and that following them there and back leads to where they were. Those that miss that by the least come first,
  /// and the distance of a match is by how much (px).
  KeypointMatches follow(const std::vector<cv::KeyPoint>& keypoints);

private:
  FlowParams params_;
  FlowImage last_, newest_;
};

}  // namespace robot_vision
