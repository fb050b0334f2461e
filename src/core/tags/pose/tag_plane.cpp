#include "robot_vision/tags/pose/tag_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "depth_samples.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxCoordinate = 1e6;  // px, of corners: beyond any image, and sums of such numbers fit an int
constexpr std::size_t kMinSamples = 12;
constexpr double kMinShare = 0.6;      // of the samples, that agree with the plane
constexpr int kRobustSteps = 6;        // of the fit with Huber's weights
constexpr double kHuberLimit = 1.345;  // standard deviations
constexpr double kMaxResidual = 4.0;   // standard deviations, of a depth that agrees with the plane
constexpr double kMedianToSigma = 1.4826;
constexpr double kMaxScatter = 9.0;  // mean squared residual, from which on the depths are of no plane

/// The residual of a sample in standard deviations.
double residualOf(const DepthSample& sample, const cv::Vec3d& plane)
{
  return (sample.inverse_depth - sample.ray.dot(plane)) / sample.noise;
}

/// A weighted fit of a plane.
struct PlaneFit
{
  cv::Vec3d plane;
  cv::Matx33d covariance;
};

/// Fits a plane, each sample with its own weight. Returns nothing if the samples lie on a line.
template <class Weight>  // double(const DepthSample&)
std::optional<PlaneFit> fitPlane(const std::vector<DepthSample>& samples, const Weight& weight)
{
  cv::Matx33d information = cv::Matx33d::zeros();
  cv::Vec3d moment;
  for (const DepthSample& sample : samples)
  {
    const double w = weight(sample) / (sample.noise * sample.noise);
    information += w * (sample.ray * sample.ray.t());
    moment += w * sample.inverse_depth * sample.ray;
  }
  // The rays to a small tag are nearly alike, and OpenCV takes such a matrix to be singular: it is scaled.
  cv::Matx33d scale = cv::Matx33d::zeros();
  for (int i = 0; i < 3; ++i)
    scale(i, i) = 1.0 / std::sqrt(std::max(information(i, i), std::numeric_limits<double>::min()));
  bool exists = false;
  const cv::Matx33d covariance = scale * (scale * information * scale).inv(cv::DECOMP_CHOLESKY, &exists) * scale;
  if (!exists || !std::isfinite(cv::norm(covariance))) return std::nullopt;
  return PlaneFit{covariance * moment, covariance};
}

double huberWeight(double residual)
{
  return std::abs(residual) <= kHuberLimit ? 1.0 : kHuberLimit / std::abs(residual);
}

/// The samples that agree with the plane of most of them. Their scatter may be larger than the sensor's noise is said
/// to be.
std::vector<DepthSample> inliersOf(const std::vector<DepthSample>& samples)
{
  std::optional<PlaneFit> fit = fitPlane(samples, [](const DepthSample&) { return 1.0; });
  double scatter = 1.0;
  std::vector<double> residuals(samples.size());
  for (int step = 0; fit && step < kRobustSteps; ++step)
  {
    std::transform(samples.begin(), samples.end(), residuals.begin(),
                   [&](const DepthSample& sample) { return std::abs(residualOf(sample, fit->plane)); });
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    scatter = std::max(kMedianToSigma * *middle, 1.0);
    fit = fitPlane(samples,
                   [&](const DepthSample& sample) { return huberWeight(residualOf(sample, fit->plane) / scatter); });
  }
  std::vector<DepthSample> inliers;
  if (!fit) return inliers;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(inliers),
               [&](const DepthSample& sample)
               { return std::abs(residualOf(sample, fit->plane)) <= kMaxResidual * scatter; });
  return inliers;
}

/// The mean squared residual, in variances of the noise.
double scatterOf(const PlaneFit& fit, const std::vector<DepthSample>& samples)
{
  double squares = 0.0;
  for (const DepthSample& sample : samples)
    squares += std::pow(residualOf(sample, fit.plane), 2);
  return squares / static_cast<double>(samples.size() - 3);
}

/// The covariance of a plane with what the noise of a pixel alone does not tell: noise that is larger than said, that
/// neighbours share, and that all depths have in common.
cv::Matx33d wholeCovariance(const PlaneFit& fit, const std::vector<DepthSample>& samples, const cv::Size& stride,
                            const DepthErrorParams& params)
{
  cv::Vec3d response;  // of the plane to a change of all depths
  for (const DepthSample& sample : samples)
  {
    const double by_depth = -sample.inverse_depth * sample.inverse_depth;
    response += by_depth / (sample.noise * sample.noise) * sample.ray;
  }
  response = fit.covariance * response;
  const double shared = std::max(static_cast<double>(params.depth_correlation) / stride.area(), 1.0);
  const double depth = 1.0 / fit.plane.dot(samples.front().ray);
  // All depths of a plane that faces the camera may lie on one step of the sensor.
  const double step = stepDeviation(depth, params);
  const double common = params.depth_bias * params.depth_bias + step * step;
  return std::max(scatterOf(fit, samples), 1.0) * shared * fit.covariance + common * (response * response.t());
}

/// Whether the plane is finite, and its covariance symmetric and positive definite.
bool isPlane(const DepthPlane& plane)
{
  const cv::Matx33d& covariance = plane.covariance;
  const double size = cv::norm(covariance);
  bool is_definite = std::isfinite(size) && size > 0.0 && cv::norm(covariance - covariance.t()) <= 1e-9 * size;
  if (is_definite) (covariance * (1.0 / size)).inv(cv::DECOMP_CHOLESKY, &is_definite);
  return is_definite && std::isfinite(cv::norm(plane.inverse_depth));
}

}  // namespace

void validate(const DepthPlane& plane)
{
  require(isPlane(plane), "plane of depths", "none", "finite, with a symmetric and positive definite covariance");
}

std::optional<DepthPlane> measureTagPlane(const cv::Mat& depth, const std::array<cv::Point2d, 4>& corners,
                                          const CameraModel& camera, const DepthErrorParams& params)
{
  checkFields(params);
  require(depth.type() == CV_32FC1 || depth.type() == CV_16UC1, "type of the depth image",
          cv::typeToString(depth.type()), "CV_32FC1 (m) or CV_16UC1 (mm)");
  require(depth.cols == camera.width && depth.rows == camera.height, "size of the depth image", toText(depth.size()),
          "that of the camera, " + sizeText(camera.width, camera.height));
  const auto is_pixel = [](const cv::Point2d& corner)
  { return std::abs(corner.x) <= kMaxCoordinate && std::abs(corner.y) <= kMaxCoordinate; };  // never NaN
  if (!std::all_of(corners.begin(), corners.end(), is_pixel)) return std::nullopt;
  const cv::Size stride = depthStride(corners);
  const std::vector<DepthSample> all = depthSamples(depth, corners, stride, camera, params);
  if (all.size() < kMinSamples) return std::nullopt;
  const std::vector<DepthSample> inliers = inliersOf(all);
  if (inliers.size() < std::max(kMinSamples, static_cast<std::size_t>(kMinShare * static_cast<double>(all.size()))))
    return std::nullopt;
  const std::optional<PlaneFit> fit = fitPlane(inliers, [](const DepthSample&) { return 1.0; });
  if (!fit || scatterOf(*fit, inliers) > kMaxScatter) return std::nullopt;
  const DepthPlane plane{fit->plane, wholeCovariance(*fit, inliers, stride, params), static_cast<int>(inliers.size())};
  // Depths of a few micrometres, or of a light year, are finite numbers, but not what follows from them.
  return isPlane(plane) ? std::optional<DepthPlane>(plane) : std::nullopt;
}

}  // namespace robot_vision
