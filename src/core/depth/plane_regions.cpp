#include "plane_regions.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr double kMinFilled = 0.5;  // share of a block's pixels that have a depth
constexpr double kFlat = 1.5;       // error of a block with regard to its own plane, standard deviations
constexpr double kSamePlane = 2.0;  // with regard to that of its region

}  // namespace

void PlaneBlocks::sumUp(const cv::Mat& inverse, const RayTable& rays)
{
  image_ = inverse.size();
  size_ = {(image_.width + kSide - 1) / kSide, (image_.height + kSide - 1) / kSide};
  sums_.assign(static_cast<std::size_t>(size_.area()), {});
  for (int y = 0; y < inverse.rows; ++y)
  {
    const auto* const w = inverse.ptr<float>(y);
    const auto *const ray_x = rays.x.ptr<float>(y), *const ray_y = rays.y.ptr<float>(y);
    PlaneSums* const row = &sums_[static_cast<std::size_t>(y / kSide * size_.width)];
    for (int x = 0; x < inverse.cols; x += kSide)
    {
      PlaneSums sums;  // apart from the others, as these are in memory and its numbers in registers
      for (int i = x; i < std::min(inverse.cols, x + kSide); ++i)
        if (w[i] > 0.0F) sums.add(ray_x[i], ray_y[i], w[i]);
      row[x / kSide] += sums;
    }
  }
}

bool PlaneBlocks::isPlanar(const PlaneSums& sums, const InversePlane& plane, const InverseNoise& noise,
                           double limit) const
{
  const double allowed = limit * noise.at(sums.w / sums.n);
  return sums.meanSquare(plane) <= allowed * allowed;
}

std::vector<PlaneRegion> PlaneBlocks::grow(const InverseNoise& noise, double min_pixels)
{
  std::vector<std::pair<double, int>> seeds;  // error, block
  is_free_.assign(sums_.size(), 0);
  for (std::size_t i = 0; i < sums_.size(); ++i)
  {
    const PlaneSums& sums = sums_[i];
    if (sums.n < kMinFilled * rect(static_cast<int>(i)).area()) continue;
    const auto plane = sums.fit();
    if (!plane || !isPlanar(sums, *plane, noise, kFlat)) continue;
    is_free_[i] = 1;
    const double deviation = noise.at(sums.w / sums.n);
    seeds.emplace_back(sums.meanSquare(*plane) / (deviation * deviation), static_cast<int>(i));
  }
  std::sort(seeds.begin(), seeds.end());
  std::vector<PlaneRegion> regions;
  for (const auto& [error, seed] : seeds)
  {
    if (is_free_[static_cast<std::size_t>(seed)] == 0) continue;
    PlaneRegion region = growFrom(seed, noise);
    if (region.sums.n >= min_pixels) regions.push_back(std::move(region));
  }
  std::stable_sort(regions.begin(), regions.end(), [](const auto& a, const auto& b) { return a.sums.n > b.sums.n; });
  return regions;
}

PlaneRegion PlaneBlocks::growFrom(int seed, const InverseNoise& noise)
{
  PlaneRegion region;
  const auto take = [&](int block)
  {
    is_free_[static_cast<std::size_t>(block)] = 0;
    region.blocks.push_back(block);
    region.sums += sums_[static_cast<std::size_t>(block)];
    region.plane = region.sums.fit().value_or(region.plane);
  };
  const auto offer = [&](int block)
  {
    const auto i = static_cast<std::size_t>(block);
    if (is_free_[i] != 0 && isPlanar(sums_[i], region.plane, noise, kSamePlane)) take(block);
  };
  take(seed);
  for (std::size_t next = 0; next < region.blocks.size(); ++next)
  {
    const int block = region.blocks[next], column = block % size_.width, row = block / size_.width;
    if (column > 0) offer(block - 1);
    if (column + 1 < size_.width) offer(block + 1);
    if (row > 0) offer(block - size_.width);
    if (row + 1 < size_.height) offer(block + size_.width);
  }
  return region;
}

cv::Rect PlaneBlocks::rect(int block) const
{
  const cv::Point corner(block % size_.width * kSide, block / size_.width * kSide);
  return cv::Rect(corner, cv::Size(kSide, kSide)) & cv::Rect({0, 0}, image_);
}

void PlaneBlocks::addParts(const PlaneRegion& region, std::vector<cv::Rect>& parts) const
{
  cv::Mat is_wanted = cv::Mat::zeros(size_, CV_8UC1);
  for (const int block : region.blocks)
  {
    const cv::Rect around(block % size_.width - 1, block / size_.width - 1, 3, 3);
    is_wanted(around & cv::Rect({0, 0}, size_)).setTo(1);
  }
  for (int row = 0; row < size_.height; ++row)
    for (int column = 0; column < size_.width; ++column)
    {
      if (is_wanted.at<std::uint8_t>(row, column) == 0) continue;
      const int first = row * size_.width + column;
      while (column + 1 < size_.width && is_wanted.at<std::uint8_t>(row, column + 1) != 0)
        ++column;
      parts.push_back(rect(first) | rect(row * size_.width + column));
    }
}

}  // namespace robot_vision
