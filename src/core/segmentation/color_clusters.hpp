#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/segmentation/segmenter.hpp"

namespace robot_vision
{

/// Divides the colours of images into clusters, by cv::kmeans.
class ColorClusters
{
public:
  /// The cluster of each pixel of an image (CV_8UC3), from 1 (CV_32SC1). The largest is the first, or if the centres of
  /// the last image are kept the clusters have its order.
  cv::Mat apply(const cv::Mat& bgr, const SegmenterParams& params);

  /// CV_32FC1, (n, 3): the colour of each cluster of the last image.
  const cv::Mat& centers() const { return centers_; }

  void forget() { centers_.release(); }

private:
  cv::Mat centers_;
};

}  // namespace robot_vision
