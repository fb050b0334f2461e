#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/recognition/pose_verifier.hpp"

namespace robot_vision
{

/// Which pixels of an image objects explain that are there for sure.
class ClaimedPixels
{
public:
  void begin(const cv::Size& image);

  /// The share of what a verdict explains that nothing has claimed.
  double unclaimed(const PoseVerdict& verdict) const;

  void claim(const PoseVerdict& verdict);

private:
  cv::Mat claimed_;  // CV_8UC1
};

}  // namespace robot_vision
