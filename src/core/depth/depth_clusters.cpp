#include "depth_clusters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/common/joined_sets.hpp"

namespace robot_vision
{
namespace
{

/// The neighbours that come before a pixel.
const std::array<cv::Point, 6> kBefore = {cv::Point{-1, 0}, {-2, 0}, {0, -1}, {0, -2}, {-1, -1}, {1, -1}};

}  // namespace

std::vector<int> DepthClusters::find(const cv::Mat& depths, float gap, cv::Mat& labels)
{
  labels.create(depths.size(), CV_32SC1);
  parents_.assign(1, 0);
  for (int y = 0; y < depths.rows; ++y)
  {
    const auto* const row = depths.ptr<float>(y);
    auto* const to = labels.ptr<std::int32_t>(y);
    for (int x = 0; x < depths.cols; ++x)
    {
      to[x] = 0;
      if (row[x] == 0.0F) continue;
      for (const cv::Point& step : kBefore)
      {
        const int column = x + step.x, above = y + step.y;
        if (column < 0 || column >= depths.cols || above < 0) continue;
        const float other = depths.at<float>(above, column);
        if (other != 0.0F && std::abs(other - row[x]) <= gap) join(to[x], labels.at<std::int32_t>(above, column));
      }
      if (to[x] != 0) continue;
      to[x] = static_cast<int>(parents_.size());
      parents_.push_back(to[x]);
    }
  }
  std::vector<int> numbers(parents_.size(), 0), pixels;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
    {
      auto& label = labels.at<std::int32_t>(y, x);
      if (label == 0) continue;
      int& number = numbers[static_cast<std::size_t>(rootOf(parents_, label))];
      if (number == 0)
      {
        pixels.push_back(0);
        number = static_cast<int>(pixels.size());
      }
      label = number;
      ++pixels[static_cast<std::size_t>(number) - 1];
    }
  return pixels;
}

/// Gives a pixel the label of a neighbour, or makes one tree of both.
void DepthClusters::join(int& label, int other)
{
  const int root = rootOf(parents_, other);
  if (label == 0)
  {
    label = root;
    return;
  }
  const int own = rootOf(parents_, label), least = std::min(own, root);
  parents_[static_cast<std::size_t>(own)] = parents_[static_cast<std::size_t>(root)] = least;
  label = least;
}

}  // namespace robot_vision
