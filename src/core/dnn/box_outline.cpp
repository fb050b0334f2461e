#include "robot_vision/dnn/box_outline.hpp"

#include <algorithm>
#include <cstddef>

namespace robot_vision
{
namespace
{

double cross(const cv::Point2d& a, const cv::Point2d& b)
{
  return a.x * b.y - a.y * b.x;
}

}  // namespace

double areaOf(const BoxOutline& box)
{
  return cross(box[1] - box[0], box[3] - box[0]);
}

double sharedArea(const BoxOutline& a, const BoxOutline& b)
{
  // Cuts `a` along each side of `b` (Sutherland, Hodgman: Reentrant Polygon Clipping, 1974). Each cut adds at most one
  // corner. Coordinates are from a corner of `a`, so that areas do not drown in the rounding of large numbers.
  std::array<cv::Point2d, 8> corners, cut;
  std::size_t count = 4;
  for (std::size_t i = 0; i < 4; ++i)
    corners[i] = a[i] - a[0];
  for (std::size_t side = 0; side < 4; ++side)
  {
    const cv::Point2d begin = b[side] - a[0], along = b[(side + 1) % 4] - b[side];
    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      const cv::Point2d p = corners[i], q = corners[(i + 1) % count];
      const double at_p = cross(along, p - begin), at_q = cross(along, q - begin);  // not below 0: inside
      if (at_p >= 0.0 && left < cut.size()) cut[left++] = p;
      if ((at_p >= 0.0) != (at_q >= 0.0) && left < cut.size()) cut[left++] = p + (q - p) * (at_p / (at_p - at_q));
    }
    corners = cut;
    count = left;
  }
  double twice = 0.0;
  for (std::size_t i = 0; i < count; ++i)
    twice += cross(corners[i], corners[(i + 1) % count]);
  return std::max(0.0, twice / 2);
}

}  // namespace robot_vision
