#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/segmentation/segmenter.hpp"
#include "seed_map.hpp"

namespace robot_vision
{

/// What a method makes of an image.
struct Division
{
  cv::Mat labels;       // CV_32SC1; 0: none
  bool by_size = true;  // the numbers follow from the sizes, not from the seeds
  std::string hint;     // what the method lacks; empty: nothing
};

// The methods for an image (CV_8UC3) that is `scale` times as large as the whole one. Images are not modified.

Division watershed(const cv::Mat& bgr, const SeedMap& seeds, const SegmenterParams& params, double scale);
Division grabCut(const cv::Mat& bgr, const SeedMap& seeds, const SegmenterParams& params);
Division floodFill(const cv::Mat& bgr, const SeedMap& seeds, const SegmenterParams& params);
Division meanShift(const cv::Mat& bgr, const SegmenterParams& params, double scale);
Division distanceTransform(const cv::Mat& bgr, const SegmenterParams& params, double scale);

}  // namespace robot_vision
