#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/segmentation/segmenter.hpp"

namespace robot_vision
{

/// Where objects are in an image, and in the middle of each a seed.
struct ObjectSeeds
{
  cv::Mat mask;     // CV_8UC1, 255 on objects
  cv::Mat markers;  // CV_32SC1, 1 to count on the seeds, 0 elsewhere
  int count = 0;
};

/// Finds the objects of an image (CV_8UC3) by Otsu's threshold, and as seeds what is farther from their outlines than a
/// share of the farthest of their pixels: things that touch have a seed each, where the neck between them is narrow.
/// Lengths of the parameters are multiplied by `scale`.
ObjectSeeds findObjectSeeds(const cv::Mat& bgr, const SegmenterParams& params, double scale);

/// Markers for cv::watershed of the image itself: the seeds, and `count + 1` away from the objects.
cv::Mat watershedMarkers(const ObjectSeeds& seeds);

/// Divides the mask among its seeds: cv::watershed of the mask, in which the water comes as far from each seed in the
/// same time. The lines between segments belong to one of them. CV_32SC1.
cv::Mat divideObjects(const ObjectSeeds& seeds);

}  // namespace robot_vision
