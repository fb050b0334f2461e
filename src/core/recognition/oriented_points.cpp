#include "oriented_points.hpp"

namespace robot_vision
{
namespace
{

constexpr float kMinCosine = 0.707F;  // between normals of points that are alike

}  // namespace

void PointThinning::begin(double distance)
{
  distance_ = distance;
  taken_.points.clear();
  taken_.normals.clear();
  near_.begin(distance);
}

void PointThinning::offer(const cv::Vec3f& point, const cv::Vec3f& normal)
{
  const auto square = static_cast<float>(distance_ * distance_);
  const auto isAlike = [&](std::size_t i)
  {
    const cv::Vec3f way = taken_.points[i] - point;
    return way.dot(way) < square && taken_.normals[i].dot(normal) > kMinCosine;
  };
  const cv::Vec3d place = point;
  if (near_.anyNear(place, isAlike)) return;
  near_.add(place, taken_.size());
  taken_.points.push_back(point);
  taken_.normals.push_back(normal);
}

}  // namespace robot_vision
