#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/segmentation/segmenter.hpp"

namespace robot_vision
{

/// The seeds in the image that is worked on, which is `scale` times as large as the whole one. Those outside of it are
/// left out. A seed's number is its place among all seeds, from 1.
class SeedMap
{
public:
  SeedMap(const std::vector<SegmentSeed>& seeds, const cv::Size& whole, const cv::Size& size,
          const SegmenterParams& params);

  bool empty() const { return spots_.empty(); }

  /// The markers of cv::watershed (CV_32SC1): the seeds' numbers, and `background` along the edges.
  cv::Mat markers(int background) const;

  /// The mask of cv::grabCut (CV_8UC1).
  cv::Mat grabCutMask() const;

  struct Spot
  {
    int number;
    cv::Rect region;  // empty: a click
    cv::Point point;
  };
  const std::vector<Spot>& spots() const { return spots_; }

private:
  cv::Size size_;
  int radius_;  // px, of the disc around a click
  int border_;  // px, of the background along the edges
  std::vector<Spot> spots_;
};

}  // namespace robot_vision
