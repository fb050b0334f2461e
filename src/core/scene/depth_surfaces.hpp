#pragma once

#include <opencv2/core.hpp>

namespace robot_vision::scene
{

// What a depth image tells of the surfaces that its pixels see. All of it is told by inverse depths, which are linear
// in the pixel where the surface is a plane.

/// Whether a number (m) is a depth: finite, and above 0.
bool isDepth(float z);

/// The inverse depths (CV_32FC1, 1/m) of a depth image (CV_32FC1, m); 0 where there is nothing.
cv::Mat inverseDepths(const cv::Mat& depth);

/// The square of the cosine between the normal of the surface at a pixel and the pixel's ray, (x, y, 1). The focal
/// lengths are in px.
double squaredCosine(const cv::Mat& inverse, const cv::Point& at, const cv::Point2d& ray, const cv::Point2d& focal);

/// The inverse depth of a pixel beside this one that is beyond an edge, 0 if there is none. `limit` is the relative
/// difference that makes an edge.
float beyondEdge(const cv::Mat& inverse, const cv::Point& at, double limit);

}  // namespace robot_vision::scene
