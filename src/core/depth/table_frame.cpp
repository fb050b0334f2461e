#include "table_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "plane_hulls.hpp"

namespace robot_vision
{

Footprint footprint(const std::vector<cv::Point2f>& points)
{
  Footprint result;
  if (points.empty()) return result;
  const cv::RotatedRect rectangle = cv::minAreaRect(points);
  result.middle = rectangle.center;
  result.length = rectangle.size.width;
  result.width = rectangle.size.height;
  result.angle = rectangle.angle * CV_PI / 180.0;
  if (result.length < result.width)
  {
    std::swap(result.length, result.width);
    result.angle += CV_PI / 2.0;
  }
  // A side has two directions. Without a rule they would take turns from image to image where the angle is near 0.
  if (result.angle > CV_PI / 2.0) result.angle -= CV_PI;
  if (result.angle <= -CV_PI / 2.0) result.angle += CV_PI;
  return result;
}

TableFrame::TableFrame(const Plane& plane) : pose_(planeFrame(plane)), to_plane_(pose_.inv())
{
  for (const cv::Point3d& corner : plane.hull)
  {
    const cv::Vec3d place = local(cv::Vec3d(corner.x, corner.y, corner.z));
    hull_.emplace_back(static_cast<float>(place[0]), static_cast<float>(place[1]));
  }
  for (std::size_t i = 0; hull_.size() >= 3 && i < hull_.size(); ++i)
  {
    const cv::Point2d from = hull_[i], side = cv::Point2d(hull_[(i + 1) % hull_.size()]) - from;
    const double length = cv::norm(side);
    if (length == 0.0) continue;
    const cv::Point2d outwards(side.y / length, -side.x / length);
    sides_.push_back({outwards, outwards.dot(from)});
  }
}

bool TableFrame::isAbove(const cv::Vec3d& place, double margin) const
{
  const cv::Point2d at(place[0], place[1]);
  return !sides_.empty() &&
         std::all_of(sides_.begin(), sides_.end(),
                     [&](const Side& side) { return side.outwards.dot(at) <= side.distance + margin; });
}

double TableFrame::area() const
{
  return hull_.size() < 3 ? 0.0 : cv::contourArea(hull_);
}

cv::Affine3d TableFrame::poseOf(const Footprint& rectangle, double height) const
{
  const double cosine = std::cos(rectangle.angle), sine = std::sin(rectangle.angle);
  const cv::Matx33d turn(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
  return pose_ * cv::Affine3d(turn, cv::Vec3d(rectangle.middle.x, rectangle.middle.y, height));
}

}  // namespace robot_vision
