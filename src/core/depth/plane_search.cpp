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

constexpr double kMinPiece = 0.1;   // of the smallest plane, that a piece of one has which something stands before
constexpr double kMaxError = 2.5;   // of a plane's pixels, standard deviations
constexpr double kMoreError = 1.2;  // by which the error of two pieces of one plane may grow if they are taken for one
constexpr double kOffset = 0.3;     // standard deviations, that it may grow by besides
constexpr std::size_t kMaxRegions = 400;  // the largest, as each is compared with all planes before it

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

/// Writes how far inverse depths are from a plane, in standard deviations; much where there is none, or NaN.
void findErrors(const float* w, const float* ray_x, const float* ray_y, int count, const InversePlane& plane,
                const InverseNoise& noise, float* __restrict errors)
{
  constexpr float kMuch = 1e9F;
  const auto a = static_cast<float>(plane.a), b = static_cast<float>(plane.b), c = static_cast<float>(plane.c);
  const auto plain = static_cast<float>(noise.noise), squared = static_cast<float>(noise.min_noise);
  for (int i = 0; i < count; ++i)
  {
    const float expected = a * ray_x[i] + b * ray_y[i] + c;
    const float error = std::abs(w[i] - expected) / (plain + squared * expected * expected);
    errors[i] = error + (w[i] > 0.0F ? 0.0F : kMuch) + (expected > 0.0F ? 0.0F : kMuch);
  }
}

}  // namespace

PlaneSearch::PlaneSearch(const CameraModel& camera, const PlaneParams& params)
  : camera_((validate(camera), camera)), params_((validate(params), params)), noise_{params.noise, params.min_noise}
{
  rays_ = rayTable(camera_);
  row_errors_.resize(static_cast<std::size_t>(camera_.width));
}

const PlaneSegmentation& PlaneSearch::find(const cv::Mat& depth, const std::string& encoding)
{
  const cv::Size size(camera_.width, camera_.height);
  checkDepth(depth, encoding, size);
  invertDepth(depth, encoding, rays_, inverse_);
  blocks_.sumUp(inverse_, rays_);
  const double min_pixels = params_.min_area * size.area();
  findCandidates(min_pixels);
  label();
  measure(min_pixels);
  findHulls(found_.labels, rays_, found_.planes);
  return found_;
}

/// Finds the planes that are large enough, the largest first, as many as are wanted.
void PlaneSearch::findCandidates(double min_pixels)
{
  candidates_.clear();
  std::vector<PlaneRegion> regions = blocks_.grow(noise_, kMinPiece * min_pixels);
  if (regions.size() > kMaxRegions) regions.resize(kMaxRegions);
  for (const PlaneRegion& region : regions)
    add(region);
  const auto is_small = [&](const Candidate& candidate) { return candidate.sums.n < min_pixels; };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), is_small), candidates_.end());
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const Candidate& a, const Candidate& b) { return a.sums.n > b.sums.n; });
  const auto most = static_cast<std::size_t>(params_.max_planes);
  if (candidates_.size() > most) candidates_.resize(most);
}

/// Adds the plane of a region, or makes the region a part of an earlier plane.
void PlaneSearch::add(const PlaneRegion& region)
{
  for (Candidate& other : candidates_)
  {
    if (!isSamePlane(other.sums, region.sums)) continue;
    other.sums += region.sums;
    other.plane = other.sums.fit().value_or(other.plane);
    blocks_.addParts(region, other.parts);
    return;
  }
  candidates_.push_back({{}, region.plane, region.sums});
  blocks_.addParts(region, candidates_.back().parts);
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
  errors_.setTo(kMaxError);
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    for (const cv::Rect& part : candidates_[i].parts)
      labelPart(part, candidates_[i].plane, static_cast<std::uint8_t>(i + 1));
}

void PlaneSearch::labelPart(const cv::Rect& part, const InversePlane& plane, std::uint8_t number)
{
  for (int y = part.y; y < part.br().y; ++y)
  {
    const std::ptrdiff_t x = part.x;
    findErrors(inverse_.ptr<float>(y) + x, rays_.x.ptr<float>(y) + x, rays_.y.ptr<float>(y) + x, part.width, plane,
               noise_, row_errors_.data());
    auto* const errors = errors_.ptr<float>(y) + x;
    auto* const labels = found_.labels.ptr(y) + x;
    for (int i = 0; i < part.width; ++i)
    {
      if (!(row_errors_[static_cast<std::size_t>(i)] < errors[i])) continue;
      errors[i] = row_errors_[static_cast<std::size_t>(i)];
      labels[i] = number;
    }
  }
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
    for (int x = 0; x < inverse_.cols;)
    {
      const std::uint8_t number = labels[x];
      if (number == 0)
      {
        ++x;
        continue;
      }
      PlaneSums of_run;
      for (; x < inverse_.cols && labels[x] == number; ++x)
        of_run.add(ray_x[x], ray_y[x], w[x]);
      sums[number - std::size_t{1}] += of_run;
    }
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
