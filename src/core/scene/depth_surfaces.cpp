#include "depth_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robot_vision::scene
{

namespace
{

const double kInfinity = std::numeric_limits<double>::infinity();

/// How 1/z changes with each pixel along a row or column of `count` pixels that are `stride` apart: to the side where
/// it changes less, because beyond an edge there is another surface.
double change(const float* inverse, int stride, int position, int count)
{
  if (count < 2) return 0.0;
  const double before = position > 0 ? inverse[0] - inverse[-stride] : kInfinity;
  const double after = position + 1 < count ? inverse[stride] - inverse[0] : kInfinity;
  return std::abs(before) < std::abs(after) ? before : after;
}

}  // namespace

bool isDepth(float z)
{
  return z > 0.0F && z <= std::numeric_limits<float>::max();
}

cv::Mat inverseDepths(const cv::Mat& depth)
{
  cv::Mat inverse(depth.size(), CV_32FC1);
  for (int row = 0; row < depth.rows; ++row)
    std::transform(depth.ptr<float>(row), depth.ptr<float>(row) + depth.cols, inverse.ptr<float>(row),
                   [](float z) { return isDepth(z) ? 1.0F / z : 0.0F; });
  return inverse;
}

double squaredCosine(const cv::Mat& inverse, const cv::Point& at, const cv::Point2d& ray, const cv::Point2d& focal)
{
  const float* here = inverse.ptr<float>(at.y) + at.x;
  // A plane has 1/z = a x + b y + c, and its normal is (a, b, c).
  const double a = change(here, 1, at.x, inverse.cols) * focal.x;
  const double b = change(here, inverse.cols, at.y, inverse.rows) * focal.y;
  const double c = *here - a * ray.x - b * ray.y;
  return *here * *here / ((a * a + b * b + c * c) * (ray.x * ray.x + ray.y * ray.y + 1.0));
}

float beyondEdge(const cv::Mat& inverse, const cv::Point& at, double limit)
{
  const float* here = inverse.ptr<float>(at.y) + at.x;
  const auto differs = [&](float other)
  { return other > 0.0F && std::abs(other - *here) > limit * std::max(other, *here); };
  if (at.x > 0 && differs(here[-1])) return here[-1];
  if (at.x + 1 < inverse.cols && differs(here[1])) return here[1];
  if (at.y > 0 && differs(here[-inverse.cols])) return here[-inverse.cols];
  if (at.y + 1 < inverse.rows && differs(here[inverse.cols])) return here[inverse.cols];
  return 0.0F;
}

}  // namespace robot_vision::scene
