#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// A pixel of a region that has a depth.
struct RegionSample
{
  int x;         // px
  int y;         // px
  float depth;   // m
  float weight;  // 1 in the middle of the region's box, 0 at its sides
};

/// Pixels of a region, each `stride`-th of each `stride`-th row, so that there are about a thousand at most.
struct RegionSamples
{
  std::vector<RegionSample> samples;
  int stride = 1;  // px
};

/// Looks at the part of a region's box, and inside of its outline (px), that is in the image: CV_16UC1 in mm or
/// CV_32FC1 in m. An outline with less than a pixel in it does not count.
RegionSamples samplesOf(const cv::Mat& depth, const cv::Rect& box, const std::vector<cv::Point2d>& outline);

}  // namespace robot_vision
