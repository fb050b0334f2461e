#include "robot_vision/depth/region_depth.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "depth_layers.hpp"
#include "region_rays.hpp"
#include "region_samples.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "sphere_distance.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxCoordinate = 10000000;       // px, beyond any image; sums of such numbers still fit an int
constexpr double kTail = 0.1;                  // of a layer's depths, left out at each end
constexpr double kTailDistance = 2.563;        // of the ends from each other, in standard deviations of normal noise
constexpr double kMedianVariance = CV_PI / 2;  // of the median of normal noise, in that of its mean

void checkRegion(const ImageRegion& region, const cv::Size& size)
{
  const cv::Rect& box = region.box;
  bool is_inside = box.width > 0 && box.height > 0 && box.x < size.width && box.y < size.height;
  for (const int value : {box.x, box.y, box.width, box.height})
    is_inside = is_inside && value >= -kMaxCoordinate && value <= kMaxCoordinate;
  is_inside = is_inside && box.x + box.width > 0 && box.y + box.height > 0;
  require(is_inside, "the box",
          sizeText(box.width, box.height) + " at (" + std::to_string(box.x) + ", " + std::to_string(box.y) + ")",
          "in the image of " + toText(size));
  requireRange("the radius", region.radius, 0.0, kMaxCoordinate);
  const auto check = [](const cv::Point2d& point)
  {
    if (std::abs(point.x) <= kMaxCoordinate && std::abs(point.y) <= kMaxCoordinate) return;  // never NaN
    require(false, "a point of the region", "(" + toText(point.x) + ", " + toText(point.y) + ")",
            "finite, and in an image");
  };
  if (region.center) check(*region.center);
  std::for_each(region.outline.begin(), region.outline.end(), check);
}

cv::Point2d centerOf(const ImageRegion& region)
{
  const cv::Rect& box = region.box;
  return region.center.value_or(cv::Point2d(box.x + 0.5 * (box.width - 1), box.y + 0.5 * (box.height - 1)));
}

/// What the samples of a layer say, m.
struct Depths
{
  double median;
  double spread;  // between the two tails
};

Depths depthsOf(const std::vector<RegionSample>& samples)
{
  std::vector<float> depths(samples.size());
  std::transform(samples.begin(), samples.end(), depths.begin(), [](const RegionSample& one) { return one.depth; });
  const auto quantile = [&](double share)
  {
    const auto place = depths.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), place, depths.end());
    return static_cast<double>(*place);
  };
  const double median = quantile(0.5), nearest = quantile(kTail);
  return {median, quantile(1.0 - kTail) - nearest};
}

/// The variance (m^2) of the median of depths that so many pixels have.
double medianVariance(const Depths& depths, std::size_t samples, int pixels, double box_error,
                      const DepthErrorParams& errors)
{
  const double noise = std::max(depthDeviation(depths.median, errors), depths.spread / kTailDistance);
  const double correlated = errors.depth_correlation;
  const double independent = std::max(std::min(static_cast<double>(samples), pixels / correlated), 1.0);
  const double moved = box_error * depths.spread;            // another part of a slanted thing
  const double step = stepDeviation(depths.median, errors);  // all depths may lie on one
  return kMedianVariance * noise * noise / independent + moved * moved + step * step +
         errors.depth_bias * errors.depth_bias;
}

/// The deviation of the pixel position of a region, px.
cv::Vec2d acrossOf(const ImageRegion& region, const LocatorParams& params)
{
  return {std::hypot(params.pixel_error, params.box_error * region.box.width),
          std::hypot(params.pixel_error, params.box_error * region.box.height)};
}

/// The covariance of a position: `relative` is the deviation of its distance from the camera, as share of that, and
/// `across` those of the pixel position that it is seen at (px).
cv::Matx33d covarianceOf(const cv::Point3d& position, double relative, const cv::Vec2d& across,
                         const CameraModel& camera)
{
  const cv::Matx23d seen = camera.projection(position).jacobian;
  const cv::Matx22d metres = cv::Matx22d(seen(0, 0), seen(0, 1), seen(1, 0), seen(1, 1)).inv();  // m/px at this depth
  const cv::Vec3d along = relative * cv::Vec3d(position);
  cv::Matx33d covariance = along * along.t();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k)
        covariance(i, j) += metres(i, k) * metres(j, k) * across[k] * across[k];
  return covariance;
}

/// Width and height of the part of a box that is in the image, m, at a depth.
cv::Vec2d sidesAt(double depth, const cv::Rect& box, const cv::Point2d& center, const CameraModel& camera)
{
  const cv::Rect part = box & cv::Rect(0, 0, camera.width, camera.height);
  const double left = rayThrough(camera, {part.x - 0.5, center.y}).x;
  const double right = rayThrough(camera, {part.br().x - 0.5, center.y}).x;
  const double top = rayThrough(camera, {center.x, part.y - 0.5}).y;
  const double bottom = rayThrough(camera, {center.x, part.br().y - 0.5}).y;
  return {depth * std::abs(right - left), depth * std::abs(bottom - top)};
}

}  // namespace

RegionLocator::RegionLocator(const CameraModel& camera, const LocatorParams& params, const DepthErrorParams& errors)
  : camera_(camera), params_(params), errors_(errors)
{
  validate(camera_);
  validate(params_);
  validate(errors_);
}

std::optional<LocatedRegion> RegionLocator::locate(const cv::Mat& depth, const std::string& encoding,
                                                   const ImageRegion& region) const
{
  const cv::Size size(camera_.width, camera_.height);
  checkDepth(depth, encoding, size);
  checkRegion(region, size);
  const auto [samples, stride] = samplesOf(depth, region.box, region.outline);
  if (samples.empty()) return std::nullopt;
  const DepthLayer layer = nearestLayer(samples, params_.min_share);
  std::vector<RegionSample> own;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(own),
               [&](const RegionSample& sample) { return layer.has(sample.depth); });
  const int pixels = static_cast<int>(own.size()) * stride * stride;
  if (own.empty() || pixels < params_.min_pixels) return std::nullopt;
  std::optional<LocatedRegion> found =
      params_.shape == "sphere" ? asSphere(own, pixels, region) : asSurface(own, pixels, region);
  if (found)
    requireFinite("the place of the region",
                  cv::norm(found->covariance) + cv::norm(found->position) + cv::norm(found->size));
  return found;
}

LocatedRegion RegionLocator::asSurface(const std::vector<RegionSample>& samples, int pixels,
                                       const ImageRegion& region) const
{
  const Depths depths = depthsOf(samples);
  const cv::Point2d center = centerOf(region), ray = rayThrough(camera_, center);
  LocatedRegion found;
  found.position = depths.median * cv::Point3d(ray.x, ray.y, 1.0);
  const double variance = medianVariance(depths, samples.size(), pixels, params_.box_error, errors_);
  found.covariance =
      covarianceOf(found.position, std::sqrt(variance) / depths.median, acrossOf(region, params_), camera_);
  const cv::Vec2d sides = sidesAt(depths.median, region.box, center, camera_);
  const double noise = kTailDistance * depthDeviation(depths.median, errors_);
  const double thickness = std::sqrt(std::max(depths.spread * depths.spread - noise * noise, 0.0));
  found.size = {sides[0], sides[1], thickness};
  found.pixels = pixels;
  return found;
}

std::optional<LocatedRegion> RegionLocator::asSphere(const std::vector<RegionSample>& samples, int pixels,
                                                     const ImageRegion& region) const
{
  const double radius = region.radius > 0.0 ? region.radius : 0.25 * (region.box.width + region.box.height);
  const SphereView view = sphereView(camera_, centerOf(region), radius);
  const std::optional<double> distance = sphereDistance(samples, camera_, view);
  if (!distance) return std::nullopt;
  const Depths depths = depthsOf(samples);
  const std::size_t asked = std::min(samples.size(), kMaxSphereSamples);
  const double variance = medianVariance(depths, asked, pixels, params_.box_error, errors_);
  // Half of the pixels are within a circle of 0.7 radii: a sphere of radius r is deeper than what is seen there by 0.7
  // r.
  const double sine = std::sin(view.radius), deeper = std::sqrt(0.5);
  const double rim = std::hypot(params_.box_error, params_.pixel_error / radius) * view.radius * std::cos(view.radius);
  const double by_rim = deeper * rim / (1.0 - deeper * sine);
  LocatedRegion found;
  found.position = cv::Point3d(*distance * view.axis);
  found.covariance = covarianceOf(found.position, std::hypot(std::sqrt(variance) / depths.median, by_rim),
                                  acrossOf(region, params_), camera_);
  found.size = cv::Vec3d::all(2.0 * *distance * sine);
  found.pixels = pixels;
  return found;
}

}  // namespace robot_vision
