#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "similarity.hpp"

namespace robot_vision
{

/// ORB features: where, and what is there.
struct Features
{
  std::vector<cv::Point2f> points;
  cv::Mat descriptors;
};

/// Features of a region of a CV_8UC1 picture, in px of the picture: those by which an object is found again.
Features objectFeatures(const cv::Mat& gray, const cv::Rect& region);

/// Up to `count` features of a picture to search for objects.
Features pictureFeatures(const cv::Mat& gray, int count);

/// Those around a region where something small was seen last, enlarged: of what is small in a picture as it is, the few
/// features look beyond its edges. None if the region is large enough for pictureFeatures().
Features nearFeatures(const cv::Mat& gray, const cv::Rect& region);

/// The similarity from the object's features to those of the picture that look alike; none if too few agree on one.
std::optional<Similarity> matchFeatures(const Features& object, const Features& picture);

}  // namespace robot_vision
