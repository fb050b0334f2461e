#include "robot_vision/ball/ball.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

const std::size_t kFewestRays = 8;

/// The vector m with m * ray = 1 for every ray of unit length on the cone: axis m / |m|, cosine of half angle 1 / |m|.
using Cone = cv::Vec3d;

/// Every pixel along a closed polygon.
std::vector<cv::Point> pixelsAlong(const std::vector<cv::Point>& polygon)
{
  std::vector<cv::Point> pixels;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const cv::Point from = polygon[i], way = polygon[(i + 1) % polygon.size()] - from;
    const int steps = std::max({std::abs(way.x), std::abs(way.y), 1});
    for (int step = 0; step < steps; ++step)
      pixels.emplace_back(from.x + way.x * step / steps, from.y + way.y * step / steps);
  }
  return pixels;
}

/// Rays of unit length through the edge of what the pixels surround. The edge runs between a pixel of the outline and
/// its neighbour outside: on average half a pixel further along the axis, x or y, that leads more directly out.
std::vector<cv::Vec3d> raysOfEdge(const CameraModel& camera, const std::vector<cv::Point>& pixels)
{
  cv::Point2d middle(0.0, 0.0);
  for (const cv::Point& pixel : pixels)
    middle += cv::Point2d(pixel) / static_cast<double>(pixels.size());

  const cv::Rect inside(1, 1, camera.width - 2, camera.height - 2);
  std::vector<cv::Vec3d> rays;
  for (const cv::Point& pixel : pixels)
  {
    if (!inside.contains(pixel)) continue;
    const cv::Point2d outwards = cv::Point2d(pixel) - middle;
    const bool sideways = std::abs(outwards.x) >= std::abs(outwards.y);
    const cv::Point2d half(sideways ? std::copysign(0.5, outwards.x) : 0.0,
                           sideways ? 0.0 : std::copysign(0.5, outwards.y));
    const cv::Point2d ray = camera.ray(cv::Point2d(pixel) + half);
    if (std::isnan(ray.x)) continue;
    rays.push_back(cv::normalize(cv::Vec3d(ray.x, ray.y, 1.0)));
  }
  return rays;
}

/// The angle (rad, to first order) by which a ray lies inside the cone.
double angleInside(const Cone& cone, const cv::Vec3d& ray)
{
  return (cone.dot(ray) - 1.0) / std::sqrt(cone.dot(cone) - 1.0);
}

/// The deviation (rad) that a share of the rays, 0 to below 1, does not exceed.
double deviationOf(double share, const Cone& cone, const std::vector<cv::Vec3d>& rays)
{
  std::vector<double> deviations;
  for (const cv::Vec3d& ray : rays)
    deviations.push_back(std::abs(angleInside(cone, ray)));
  const auto largest = deviations.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(rays.size()));
  std::nth_element(deviations.begin(), largest, deviations.end());
  return *largest;
}

double medianDeviation(const Cone& cone, const std::vector<cv::Vec3d>& rays)
{
  return deviationOf(0.5, cone, rays);
}

/// Whether it is a cone around something in front of the camera; not if numbers are not finite.
bool isCone(const Cone& cone)
{
  return cone.dot(cone) > 1.0 && cone[2] > 0.0 && std::isfinite(cone.dot(cone));
}

/// The cone through three rays a fifth of the outline apart that leaves the least median deviation; 0 if there is none.
/// Three such rays reach over less than the half of a ball's outline.
Cone roughCone(const std::vector<cv::Vec3d>& rays)
{
  const std::size_t most_trials = 30, count = rays.size(), trials = std::min(most_trials, count);
  Cone best(0.0, 0.0, 0.0);
  double least = HUGE_VAL;
  for (std::size_t trial = 0; trial < trials; ++trial)
  {
    const std::size_t first = trial * count / trials;
    cv::Matx33d three;
    for (std::size_t i = 0; i < 3; ++i)
    {
      const cv::Vec3d& ray = rays[(first + i * count / 5) % count];
      for (int j = 0; j < 3; ++j)
        three(static_cast<int>(i), j) = ray[j];
    }
    const Cone cone = three.solve(cv::Vec3d(1.0, 1.0, 1.0), cv::DECOMP_LU);
    const double deviation = isCone(cone) ? medianDeviation(cone, rays) : HUGE_VAL;
    if (!(deviation < least)) continue;
    least = deviation;
    best = cone;
  }
  return best;
}

/// One step of iteratively reweighted least squares. `grain` (rad): the deviations that even a perfect outline has.
Cone refined(const Cone& cone, const std::vector<cv::Vec3d>& rays, double grain)
{
  const double sigma_per_median = 1.4826, tukey = 4.685;  // 95 % efficient for normal deviations
  const double limit = tukey * std::max(sigma_per_median * medianDeviation(cone, rays), grain);
  cv::Matx33d squares;
  cv::Vec3d sum(0.0, 0.0, 0.0);
  for (const cv::Vec3d& ray : rays)
  {
    const double part = angleInside(cone, ray) / limit, weight = std::pow(std::max(1.0 - part * part, 0.0), 2);
    squares += weight * (ray * ray.t());
    sum += weight * ray;
  }
  return squares.solve(sum, cv::DECOMP_LU);
}

/// Whether enough of the outline lies on the cone, and the cone is not much wider than the outline. `grain` (rad): as
/// above; `extent` (rad): width and height of the outline.
bool fits(const Cone& cone, const std::vector<cv::Vec3d>& rays, double grain, const cv::Size2d& extent)
{
  // Of the border of half a disc 59 % is arc, less with something of the same colour beside it. Of a square as much is
  // off by more than this. A bar fits a cone by one of its sides, but a cone far too wide.
  const double arc = 0.4, coarse = 3.5 * grain, ragged = 0.025 * std::min(extent.width, extent.height);
  const double width = 2.0 * std::acos(1.0 / std::sqrt(cone.dot(cone)));
  return deviationOf(arc, cone, rays) <= std::max(coarse, ragged) &&
         width <= 1.5 * std::max(extent.width, extent.height);
}

}  // namespace

std::optional<BallPosition> ballPosition(const CameraModel& camera, const std::vector<cv::Point>& outline,
                                         double diameter)
{
  validate(camera);
  require(diameter > 0.0 && std::isfinite(diameter), "diameter", diameter, "positive (m)");
  const std::string size = std::to_string(camera.width) + "x" + std::to_string(camera.height);
  for (const cv::Point& pixel : outline)
    require(pixel.inside({0, 0, camera.width, camera.height}), "outline point",
            "(" + std::to_string(pixel.x) + ", " + std::to_string(pixel.y) + ")", "in the camera's picture, " + size);
  const std::vector<cv::Vec3d> rays = raysOfEdge(camera, pixelsAlong(outline));
  if (rays.size() < kFewestRays) return std::nullopt;

  const int steps = 5;
  const double grain = 0.29 / camera.K(0, 0);  // of positions rounded to pixels: 1 / sqrt(12)
  Cone cone = roughCone(rays);
  for (int step = 0; step < steps && isCone(cone); ++step)
    cone = refined(cone, rays, grain);
  const cv::Rect box = cv::boundingRect(outline);
  const cv::Size2d extent(box.width / camera.K(0, 0), box.height / camera.K(1, 1));
  if (!isCone(cone) || !fits(cone, rays, grain, extent)) return std::nullopt;

  const double squared = cone.dot(cone), sine = std::sqrt(1.0 - 1.0 / squared);
  const cv::Point3d position(cone * (0.5 * diameter / sine / std::sqrt(squared)));
  return BallPosition{position, camera.project(position)};
}

std::optional<std::size_t> chooseBall(const std::vector<BallCandidate>& candidates, double min_roundness,
                                      const std::optional<cv::Point2d>& expected)
{
  requireRange("min_roundness", min_roundness, 0.0, 1.0);
  const auto better = [&](const BallCandidate& a, const BallCandidate& b)
  { return expected ? cv::norm(a.center - *expected) < cv::norm(b.center - *expected) : a.area > b.area; };
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].roundness >= min_roundness && (!best || better(candidates[i], candidates[*best]))) best = i;
  return best;
}

}  // namespace robot_vision
