#include "plane_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "inverse_depth.hpp"
#include "plane_hulls.hpp"
#include "robot_vision/depth/depth_image.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxError = 2.5;   // of a plane's pixels, standard deviations
constexpr double kMoreError = 1.2;  // by which the error of two pieces of one plane may grow if they are taken for one
constexpr double kOffset = 0.3;     // standard deviations, that it may grow by besides

Plane toPlane(const InversePlane& fitted, const PlaneSums& sums, const InverseNoise& noise)
{
  Plane plane;
  const cv::Vec3d scaled(fitted.a, fitted.b, fitted.c);
  const double length = cv::norm(scaled);
  plane.normal = -1.0 / length * scaled;
  plane.distance = 1.0 / length;
  plane.pixels = static_cast<int>(sums.n);
  const cv::Vec3d middle(sums.x / sums.n, sums.y / sums.n, 1.0);
  plane.center = cv::Point3d(1.0 / scaled.dot(middle) * middle);
  plane.deviation = std::sqrt(sums.meanSquare(fitted)) / noise.at(sums.w / sums.n);
  return plane;
}

}  // namespace

PlaneSearch::PlaneSearch(const CameraModel& camera, const PlaneParams& params)
  : camera_((validate(camera), camera)), params_((validate(params), params)), noise_{params.noise, params.min_noise}
{
  rays_ = rayTable(camera_);
}

const PlaneSegmentation& PlaneSearch::find(const cv::Mat& depth, const std::string& encoding)
{
  const cv::Size size(camera_.width, camera_.height);
  checkDepth(depth, encoding, size);
  invertDepth(depth, encoding, rays_, inverse_);
  blocks_.sumUp(inverse_, rays_);
  candidates_.clear();
  const double min_pixels = params_.min_area * size.area();
  for (const PlaneRegion& region : blocks_.grow(noise_, min_pixels))
    add(region);
  const auto most = static_cast<std::size_t>(params_.max_planes);
  if (candidates_.size() > most) candidates_.resize(most);
  label();
  measure(min_pixels);
  findHulls(found_.labels, rays_, found_.planes);
  return found_;
}

/// Calls use(x, y, error) for the pixels of some blocks that are on a plane; the error is at most 1.
template <class Use>
void PlaneSearch::forPixels(const std::vector<int>& blocks, const InversePlane& plane, const Use& use) const
{
  const auto a = static_cast<float>(plane.a), b = static_cast<float>(plane.b), c = static_cast<float>(plane.c);
  const auto noise = static_cast<float>(kMaxError * noise_.noise);
  const auto min_noise = static_cast<float>(kMaxError * noise_.min_noise);
  for (const int block : blocks)
  {
    const cv::Rect part = blocks_.rect(block);
    for (int y = part.y; y < part.br().y; ++y)
    {
      const auto* const w = inverse_.ptr<float>(y);
      const auto *const ray_x = rays_.x.ptr<float>(y), *const ray_y = rays_.y.ptr<float>(y);
      for (int x = part.x; x < part.br().x; ++x)
      {
        const float expected = a * ray_x[x] + b * ray_y[x] + c;
        const float error = std::abs(w[x] - expected) / (noise + min_noise * expected * expected);
        if (error <= 1.0F && w[x] > 0.0F && expected > 0.0F) use(x, y, error);
      }
    }
  }
}

/// Adds the plane of a region, fitted to the pixels in and beside it, or makes the region a part of an earlier plane.
void PlaneSearch::add(const PlaneRegion& region)
{
  Candidate candidate;
  candidate.blocks = blocks_.withNeighbours(region);
  forPixels(candidate.blocks, region.plane,
            [&](int x, int y, float /*error*/)
            { candidate.sums.add(rays_.x.at<float>(y, x), rays_.y.at<float>(y, x), inverse_.at<float>(y, x)); });
  const auto fitted = candidate.sums.fit();
  if (!fitted) return;
  candidate.plane = *fitted;
  for (Candidate& other : candidates_)
  {
    if (!isSamePlane(other.sums, candidate.sums)) continue;
    other.sums += candidate.sums;
    other.plane = other.sums.fit().value_or(other.plane);
    other.blocks.insert(other.blocks.end(), candidate.blocks.begin(), candidate.blocks.end());
    return;
  }
  candidates_.push_back(std::move(candidate));
}

/// Whether one plane fits the pixels of two as well as their own planes do.
bool PlaneSearch::isSamePlane(const PlaneSums& a, const PlaneSums& b) const
{
  PlaneSums both = a;
  both += b;
  const auto joint = both.fit();
  if (!joint) return false;
  const auto fits = [&](const PlaneSums& sums)
  {
    const double own = kMoreError * kMoreError * sums.meanSquare(sums.fit().value_or(*joint));
    const double offset = kOffset * noise_.at(sums.w / sums.n);
    return sums.meanSquare(*joint) <= own + offset * offset;
  };
  return fits(a) && fits(b);
}

/// Gives each pixel the plane that it is nearest to, so that planes do not take each other's pixels where they meet.
void PlaneSearch::label()
{
  found_.labels.create(inverse_.size(), CV_8UC1);
  found_.labels.setTo(0);
  errors_.create(inverse_.size(), CV_32FC1);
  errors_.setTo(2.0);  // more than any
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    forPixels(candidates_[i].blocks, candidates_[i].plane,
              [&](int x, int y, float error)
              {
                if (error >= errors_.at<float>(y, x)) return;
                errors_.at<float>(y, x) = error;
                found_.labels.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(i + 1);
              });
}

/// Fits the planes to their pixels, leaves out those that are too small, and puts the one with most pixels first.
void PlaneSearch::measure(double min_pixels)
{
  std::vector<PlaneSums> sums(candidates_.size());
  for (int y = 0; y < inverse_.rows; ++y)
  {
    const auto* const labels = found_.labels.ptr(y);
    const auto* const w = inverse_.ptr<float>(y);
    const auto *const ray_x = rays_.x.ptr<float>(y), *const ray_y = rays_.y.ptr<float>(y);
    for (int x = 0; x < inverse_.cols; ++x)
      if (labels[x] != 0) sums[labels[x] - std::size_t{1}].add(ray_x[x], ray_y[x], w[x]);
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i].n >= min_pixels && sums[i].fit()) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sums[a].n > sums[b].n; });
  found_.planes.clear();
  cv::Mat numbers = cv::Mat::zeros(1, 256, CV_8UC1);
  for (const std::size_t i : order)
  {
    found_.planes.push_back(toPlane(*sums[i].fit(), sums[i], noise_));
    numbers.at<std::uint8_t>(static_cast<int>(i) + 1) = static_cast<std::uint8_t>(found_.planes.size());
  }
  cv::LUT(found_.labels, numbers, found_.labels);
}

}  // namespace robot_vision
