#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "similarity.hpp"

namespace robot_vision
{

/// ORB keypoints and their descriptors.
struct Features
{
  std::vector<cv::Point2f> points;  // px
  cv::Mat descriptors;              // a row for each point
};

/// The features of a region of a CV_8UC1 image, by which an object is found again. Points are in px of the image.
Features objectFeatures(const cv::Mat& gray, const cv::Rect& region);

/// Up to `count` features of a whole image.
Features imageFeatures(const cv::Mat& gray, int count);

/// The features around a region in which a small object was seen last, computed on an enlarged part of the image: the
/// descriptors of a small object would otherwise depend on what is around it. None if the region is so large that
/// imageFeatures() will do.
Features nearFeatures(const cv::Mat& gray, const cv::Rect& region);

/// The similarity that maps the object's features to matching features of the image; none if too few agree on one.
std::optional<Similarity> matchFeatures(const Features& object, const Features& image);

}  // namespace robot_vision
