#include "contour_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "color_gradients.hpp"

namespace robot_vision
{
namespace
{

constexpr float kSteepest = 4.0F;      // tangent of 76 degrees: what seems to be steeper is a jump
constexpr float kMinCrease = 0.5F;     // between the normals of two sides, of length 1: 29 degrees
constexpr float kMinTexture = 100.0F;  // Sobel's, of 12 gray levels a pixel
constexpr float kMinSlope = 0.08F;     // of the blurred mask, where it tells the outline's place

ContourPoint pointAt(const RenderedRegion& region, const cv::Point2f& place, float depth, const cv::Vec2f& normal,
                     bool is_outline)
{
  const cv::Vec3d point =
      static_cast<double>(depth) * region.camera.ray(static_cast<double>(place.x), static_cast<double>(place.y));
  return {cv::Vec3f(point - region.center), normal, is_outline};
}

/// Where the steps of a blurred mask are: the place from the middle of a pixel, and the direction out of the mask.
bool crossing(const cv::Mat& smooth, int x, int y, cv::Point2f& place, cv::Vec2f& normal)
{
  const float along_x = 0.5F * (smooth.at<float>(y, x + 1) - smooth.at<float>(y, x - 1));
  const float along_y = 0.5F * (smooth.at<float>(y + 1, x) - smooth.at<float>(y - 1, x));
  const float slope = std::hypot(along_x, along_y);
  if (slope < kMinSlope) return false;
  normal = cv::Vec2f(-along_x / slope, -along_y / slope);
  const float distance = std::clamp((smooth.at<float>(y, x) - 0.5F) / slope, -1.0F, 1.5F);
  place = cv::Point2f(static_cast<float>(x) + distance * normal[0], static_cast<float>(y) + distance * normal[1]);
  return true;
}

}  // namespace

const std::vector<ContourPoint>& ContourPointFinder::find(const RenderedRegion& region, bool texture,
                                                          const ContourLimits& limits)
{
  points_.clear();
  findInside(region);
  addOutline(region);
  std::size_t found = more_.size();
  keep(limits.outline);
  findCreases(region);
  addRidges(region, kMinCrease);
  if (texture)
  {
    findTexture(region);
    addRidges(region, kMinTexture);
  }
  found += more_.size();
  keep(limits.inner);
  spacing_ = static_cast<double>(found) / static_cast<double>(std::max<std::size_t>(points_.size(), 1));
  return points_;
}

/// Appends at most so many of what was found, evenly.
void ContourPointFinder::keep(int count)
{
  const std::size_t step = std::max<std::size_t>(1, (more_.size() + count - 1) / static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < more_.size(); i += step)
    points_.push_back(more_[i]);
  more_.clear();
}

void ContourPointFinder::findInside(const RenderedRegion& region)
{
  const cv::Mat& depth = region.view.depth;
  mask_.create(depth.size(), CV_32FC1);
  inside_.create(depth.size(), CV_8UC1);
  inside_.setTo(0);
  for (int y = 0; y < depth.rows; ++y)
  {
    const auto* const z = depth.ptr<float>(y);
    auto* const mask = mask_.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x)
      mask[x] = z[x] > 0.0F ? 1.0F : 0.0F;
  }
  const auto largest = kSteepest * static_cast<float>(region.camera.pixelWidth());  // of a depth, from pixel to pixel
  for (int y = 1; y + 1 < depth.rows; ++y)
  {
    const float *const above = depth.ptr<float>(y - 1), *const z = depth.ptr<float>(y),
                       *const below = depth.ptr<float>(y + 1);
    for (int x = 1; x + 1 < depth.cols; ++x)
    {
      const float jump = largest * z[x];
      bool is_inside = z[x] > 0.0F;
      for (const float* row : {above, z, below})
        for (int i = x - 1; i <= x + 1; ++i)
          is_inside &= std::abs(row[i] - z[x]) <= 2.0F * jump;  // false for what is not drawn, whose depth is NaN
      inside_.at<std::uint8_t>(y, x) = is_inside ? 255 : 0;
    }
  }
}

void ContourPointFinder::addOutline(const RenderedRegion& region)
{
  cv::GaussianBlur(mask_, smooth_, {5, 5}, 1.0, 1.0, cv::BORDER_REPLICATE);
  for (int y = 1; y + 1 < mask_.rows; ++y)
  {
    const float *const above = mask_.ptr<float>(y - 1), *const here = mask_.ptr<float>(y),
                       *const below = mask_.ptr<float>(y + 1);
    for (int x = 1; x + 1 < mask_.cols; ++x)
    {
      if (here[x] == 0.0F || here[x - 1] + here[x + 1] + above[x] + below[x] == 4.0F) continue;
      cv::Point2f place;
      cv::Vec2f normal;
      if (crossing(smooth_, x, y, place, normal))
        more_.push_back(pointAt(region, place, region.view.depth.at<float>(y, x), normal, true));
    }
  }
}

/// Writes how the normals change: of x, y and z the one that does so most.
void ContourPointFinder::findCreases(const RenderedRegion& region)
{
  const cv::Mat& normals = region.view.normals;
  slopes_.create(inside_.size(), CV_32FC2);
  strength_.create(inside_.size(), CV_32FC1);
  strength_.setTo(0.0F);
  for (int y = 1; y + 1 < inside_.rows; ++y)
    for (int x = 1; x + 1 < inside_.cols; ++x)
    {
      if (inside_.at<std::uint8_t>(y, x) == 0) continue;
      const cv::Vec3f across = normals.at<cv::Vec3f>(y, x + 1) - normals.at<cv::Vec3f>(y, x - 1);
      const cv::Vec3f along = normals.at<cv::Vec3f>(y + 1, x) - normals.at<cv::Vec3f>(y - 1, x);
      int most = 0;
      for (int i = 1; i < 3; ++i)
        if (std::hypot(across[i], along[i]) > std::hypot(across[most], along[most])) most = i;
      slopes_.at<cv::Vec2f>(y, x) = {across[most], along[most]};
      strength_.at<float>(y, x) = std::sqrt(across.dot(across) + along.dot(along));
    }
}

void ContourPointFinder::findTexture(const RenderedRegion& region)
{
  colorGradients(region.view.bgr, gradients_);
  cv::erode(inside_, inside_, cv::Mat());  // gradients are of 3x3 pixels, too
  strength_.setTo(0.0F);
  for (int y = 1; y + 1 < inside_.rows; ++y)
    for (int x = 1; x + 1 < inside_.cols; ++x)
    {
      if (inside_.at<std::uint8_t>(y, x) == 0) continue;
      const auto& gradient = gradients_.at<cv::Vec2s>(y, x);
      const cv::Vec2f slopes(static_cast<float>(gradient[0]), static_cast<float>(gradient[1]));
      slopes_.at<cv::Vec2f>(y, x) = slopes;
      strength_.at<float>(y, x) = std::hypot(slopes[0], slopes[1]);
    }
}

/// Adds the places where something changes more than on both sides.
void ContourPointFinder::addRidges(const RenderedRegion& region, float min_strength)
{
  for (int y = 1; y + 1 < strength_.rows; ++y)
    for (int x = 1; x + 1 < strength_.cols; ++x)
    {
      const float strength = strength_.at<float>(y, x);
      if (strength < min_strength) continue;
      const auto& slopes = slopes_.at<cv::Vec2f>(y, x);
      const bool is_across = std::abs(slopes[0]) >= std::abs(slopes[1]);
      const float before = is_across ? strength_.at<float>(y, x - 1) : strength_.at<float>(y - 1, x);
      const float behind = is_across ? strength_.at<float>(y, x + 1) : strength_.at<float>(y + 1, x);
      if (strength <= before || strength < behind) continue;
      const float offset = 0.5F * (before - behind) / (before - 2.0F * strength + behind);
      const cv::Point2f place(static_cast<float>(x) + (is_across ? offset : 0.0F),
                              static_cast<float>(y) + (is_across ? 0.0F : offset));
      more_.push_back(pointAt(region, place, region.view.depth.at<float>(y, x), cv::normalize(slopes), false));
    }
}

}  // namespace robot_vision
