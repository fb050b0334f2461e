#include "pose_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr double kContourCorrelation = 15.0;  // px along a contour that share the error of their edge
constexpr double kDepthEdgeError = 1.5;       // px, standard deviation of where depths jump
constexpr double kGate = 4.0;                 // standard deviations, that a depth is off if it is of something else
constexpr double kMinGate = 0.008;            // m
constexpr double kInward = 2.0;               // px, from an outline to where its own surface is seen for sure

/// As std::hypot(), which takes care of numbers that there are none of here.
double lengthOf(double a, double b)
{
  return std::sqrt(a * a + b * b);
}

/// The derivative of a pixel's position along `normal` by its point.
cv::Vec3d byPoint(const Pinhole& camera, const cv::Vec3d& point, const cv::Vec2f& normal)
{
  const double nx = static_cast<double>(normal[0]), ny = static_cast<double>(normal[1]), inverse = 1.0 / point[2];
  const double across = nx * camera.fx * inverse, along = (nx * camera.skew + ny * camera.fy) * inverse;
  return {across, along, -(across * point[0] + along * point[1]) * inverse};
}

}  // namespace

void takeSurfacePoints(const RenderedRegion& region, int max_count, std::vector<SurfacePoint>& points)
{
  points.clear();
  const cv::Mat& depth = region.view.depth;
  const double drawn = drawnPixels(region.view);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(drawn / max_count))));
  for (int y = step / 2; y < depth.rows; y += step)
    for (int x = step / 2; x < depth.cols; x += step)
    {
      const auto z = static_cast<double>(depth.at<float>(y, x));
      if (!(z > 0.0)) continue;
      points.push_back(
          {z * region.camera.ray(x, y) - region.center, cv::Vec3d(region.view.normals.at<cv::Vec3f>(y, x))});
    }
}

PoseResiduals::PoseResiduals(const RecognitionFrame& frame, const DepthErrorParams& errors, double contour_error,
                             double min_gradient)
  : frame_(frame),
    errors_(errors),
    contour_error_(contour_error),
    camera_(frame.camera().K),
    pixel_width_(camera_.pixelWidth()),
    search_(frame, min_gradient)
{
}

void PoseResiduals::setDensity(double surface_pixels, double contour_pixels)
{
  surface_share_ = std::min(surface_pixels / errors_.depth_correlation, 1.0);
  contour_share_ = std::min(contour_pixels / kContourCorrelation, 1.0);
}

double PoseResiduals::surfaceDeviation(double depth, const cv::Vec3d& ray, const cv::Vec3d& normal) const
{
  const double along = normal.dot(ray), across = std::sqrt(std::max(ray.dot(ray) - along * along, 0.0));
  return lengthOf(depthDeviation(depth, errors_) * along, 0.5 * pixel_width_ * depth * across);
}

cv::Matx66d PoseResiduals::surfaceInformation(const std::vector<SurfacePoint>& surface, const cv::Vec3d& center) const
{
  PoseEquations equations;
  for (const SurfacePoint& sample : surface)
  {
    const cv::Vec3d point = center + sample.point;
    const double deviation = surfaceDeviation(point[2], point * (1.0 / point[2]), sample.normal);
    equations.add(sample.normal, sample.point, 0.0, deviation, surface_share_);
  }
  return equations.information();
}

double PoseResiduals::distanceBehind(const cv::Vec3d& point) const
{
  if (!(point[2] > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(search_.depthAt(camera_.project(point))) - point[2];
}

void PoseResiduals::match(const std::vector<ContourPoint>& contours, const cv::Matx33d& turned, const cv::Vec3d& center,
                          const FitTolerance& tolerance)
{
  matches_.clear();
  for (const ContourPoint& contour : contours)
    matches_.push_back(matchOf(contour, center + turned * cv::Vec3d(contour.point), tolerance));
}

void PoseResiduals::add(const std::vector<SurfacePoint>& surface, const std::vector<ContourPoint>& contours,
                        const cv::Matx33d& turned, const cv::Vec3d& center, const FitTolerance& tolerance,
                        PoseEquations& equations) const
{
  if (frame_.hasDepth())
    for (const SurfacePoint& sample : surface)
      if (!addSurface(sample, turned, center, tolerance.shift, equations)) equations.addMissing(surface_share_);
  for (std::size_t i = 0; i < contours.size(); ++i)
    addContour(contours[i], matches_[i], turned, center, tolerance.pixels, equations);
}

/// Returns false where no depth was measured.
bool PoseResiduals::addSurface(const SurfacePoint& sample, const cv::Matx33d& turned, const cv::Vec3d& center,
                               double shift, PoseEquations& equations) const
{
  const cv::Vec3d lever = turned * sample.point, point = center + lever, normal = turned * sample.normal;
  if (!(point[2] > 0.0)) return false;
  const cv::Point2d place = camera_.project(point);
  const auto z = static_cast<double>(search_.depthAt(place));
  if (!(z > 0.0)) return false;
  const cv::Vec3d ray = camera_.ray(cvRound(place.x), cvRound(place.y));
  const double deviation = lengthOf(surfaceDeviation(z, ray, normal), shift);
  equations.add(normal, lever, normal.dot(z * ray - point), deviation, surface_share_);
  return true;
}

ContourMatch PoseResiduals::matchOf(const ContourPoint& contour, const cv::Vec3d& point,
                                    const FitTolerance& tolerance) const
{
  ContourMatch match;
  const double depth = point[2];
  if (!(depth > 0.0)) return match;
  match.place = camera_.project(point);
  const double gate = std::max({kGate * depthDeviation(depth, errors_), 2.0 * tolerance.shift, kMinGate});
  if (frame_.hasDepth())
  {
    const double inward = contour.is_outline ? kInward : 0.0;
    const float before = search_.depthAt(match.place - inward * cv::Point2d(cv::Vec2d(contour.normal)));
    if (static_cast<double>(before) < depth - gate) return match;
    if (contour.is_outline)
      match.by_depth = search_.depthEdge(match.place, contour.normal, tolerance.radius, depth, gate);
  }
  match.is_hidden = false;
  if (frame_.hasColors()) match.by_color = search_.colorEdge(match.place, contour.normal, tolerance.radius);
  return match;
}

void PoseResiduals::addContour(const ContourPoint& contour, const ContourMatch& match, const cv::Matx33d& turned,
                               const cv::Vec3d& center, double tolerance, PoseEquations& equations) const
{
  const cv::Vec3d lever = turned * cv::Vec3d(contour.point), point = center + lever;
  if (match.is_hidden || !(point[2] > 0.0)) return equations.addMissing(contour_share_);
  const cv::Point2d moved = camera_.project(point) - match.place;
  const double way = moved.dot(cv::Point2d(cv::Vec2d(contour.normal)));
  const cv::Vec3d direction = byPoint(camera_, point, contour.normal);
  const auto add = [&](const std::optional<double>& matched, double error)
  {
    if (matched)
      equations.add(direction, lever, *matched - way, lengthOf(error, tolerance), contour_share_);
    else
      equations.addMissing(contour_share_);
  };
  if (frame_.hasColors()) add(match.by_color, contour_error_);
  if (frame_.hasDepth() && contour.is_outline) add(match.by_depth, kDepthEdgeError);
}

}  // namespace robot_vision
