#include "robot_vision/ball/ball.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

const std::size_t kMinRays = 8;

/// A cone as the vector m with m * ray = 1 for all its rays of unit length: its axis is m / |m|, the cosine of its half
/// angle 1 / |m|.
using Cone = cv::Vec3d;

/// All pixels along a closed polygon.
std::vector<cv::Point> pixelsAlong(const std::vector<cv::Point>& polygon)
{
  std::vector<cv::Point> pixels;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const cv::Point from = polygon[i], side = polygon[(i + 1) % polygon.size()] - from;
    const int steps = std::max({std::abs(side.x), std::abs(side.y), 1});
    for (int step = 0; step < steps; ++step)
      pixels.emplace_back(from.x + side.x * step / steps, from.y + side.y * step / steps);
  }
  return pixels;
}

/// Rays of unit length through the edge of the region that the pixels surround. The edge runs between a pixel of the
/// outline and its neighbour outside, on average half a pixel further out along x or y, whichever leads more directly
/// out.
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
    const bool horizontal = std::abs(outwards.x) >= std::abs(outwards.y);
    const cv::Point2d half(horizontal ? std::copysign(0.5, outwards.x) : 0.0,
                           horizontal ? 0.0 : std::copysign(0.5, outwards.y));
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

/// The quantile (0 to below 1) of the rays' absolute deviations from the cone, in rad.
double deviationQuantile(double quantile, const Cone& cone, const std::vector<cv::Vec3d>& rays)
{
  std::vector<double> deviations;
  for (const cv::Vec3d& ray : rays)
    deviations.push_back(std::abs(angleInside(cone, ray)));
  const auto nth = deviations.begin() + static_cast<std::ptrdiff_t>(quantile * static_cast<double>(rays.size()));
  std::nth_element(deviations.begin(), nth, deviations.end());
  return *nth;
}

double medianDeviation(const Cone& cone, const std::vector<cv::Vec3d>& rays)
{
  return deviationQuantile(0.5, cone, rays);
}

/// Whether the vector describes a cone in front of the camera. False if its numbers are not finite.
bool isCone(const Cone& cone)
{
  return cone.dot(cone) > 1.0 && cone[2] > 0.0 && std::isfinite(cone.dot(cone));
}

/// The cone through three rays that has the smallest median deviation, or 0 if there is none. The rays are a fifth of
/// the outline apart, so that all three may lie on the visible part of a half-hidden ball.
Cone roughCone(const std::vector<cv::Vec3d>& rays)
{
  const std::size_t max_trials = 30, count = rays.size(), trials = std::min(max_trials, count);
  Cone best(0.0, 0.0, 0.0);
  double min_deviation = HUGE_VAL;
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
    if (!(deviation < min_deviation)) continue;
    min_deviation = deviation;
    best = cone;
  }
  return best;
}

/// One step of iteratively reweighted least squares. `pixel_noise` is the standard deviation (rad) of a perfect
/// outline's rays, whose positions are rounded to pixels.
Cone refined(const Cone& cone, const std::vector<cv::Vec3d>& rays, double pixel_noise)
{
  const double sigma_per_median = 1.4826, tukey = 4.685;  // for an efficiency of 95 % with normal deviations
  const double limit = tukey * std::max(sigma_per_median * medianDeviation(cone, rays), pixel_noise);
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

/// Whether enough of the outline lies on the cone, and the cone is not much wider than the outline. `extent` is the
/// width and height of the outline (rad).
bool fits(const Cone& cone, const std::vector<cv::Vec3d>& rays, double pixel_noise, const cv::Size2d& extent)
{
  // The arc is 59 % of the border of half a disc, and less of one that touches something of the same colour. The same
  // share of a square's border deviates by more than the limit. One side of a bar fits a cone, but one that is too
  // wide.
  const double arc_share = 0.4;
  const double max_deviation = std::max(3.5 * pixel_noise, 0.025 * std::min(extent.width, extent.height));
  const double width = 2.0 * std::acos(1.0 / std::sqrt(cone.dot(cone)));
  return deviationQuantile(arc_share, cone, rays) <= max_deviation &&
         width <= 1.5 * std::max(extent.width, extent.height);
}

}  // namespace

std::optional<BallPosition> ballPosition(const CameraModel& camera, const std::vector<cv::Point>& outline,
                                         double diameter)
{
  validate(camera);
  require(diameter > 0.0 && std::isfinite(diameter), "diameter", diameter, "positive (m)");
  const std::string size = sizeText(camera.width, camera.height);
  for (const cv::Point& pixel : outline)
    require(pixel.inside({0, 0, camera.width, camera.height}), "outline point",
            "(" + std::to_string(pixel.x) + ", " + std::to_string(pixel.y) + ")", "in the camera's image, " + size);
  const std::vector<cv::Vec3d> rays = raysOfEdge(camera, pixelsAlong(outline));
  if (rays.size() < kMinRays) return std::nullopt;

  const int steps = 5;
  const double pixel_noise = 0.29 / camera.K(0, 0);  // 1 / sqrt(12) px
  Cone cone = roughCone(rays);
  for (int step = 0; step < steps && isCone(cone); ++step)
    cone = refined(cone, rays, pixel_noise);
  const cv::Rect box = cv::boundingRect(outline);
  const cv::Size2d extent(box.width / camera.K(0, 0), box.height / camera.K(1, 1));
  if (!isCone(cone) || !fits(cone, rays, pixel_noise, extent)) return std::nullopt;

  const double squared_norm = cone.dot(cone), sine = std::sqrt(1.0 - 1.0 / squared_norm);
  const cv::Point3d position(cone * (0.5 * diameter / sine / std::sqrt(squared_norm)));
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
