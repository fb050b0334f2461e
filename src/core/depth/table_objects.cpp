#include "table_objects.hpp"

#include <algorithm>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr int kMaxSamples = 2000;   // of the pixels of an object, that its footprint is found by
constexpr double kTopShare = 0.99;  // of an object's pixels that are below its top: the rest may be noise

}  // namespace

void TableObjects::begin(const cv::Size& size)
{
  count_ = 0;
  labels_.create(size, CV_16UC1);
  labels_.setTo(0);
}

std::vector<TableObject> TableObjects::find(const cv::Mat& depths, const TableFrame& frame)
{
  const std::vector<int> pixels = clusters_.find(depths, static_cast<float>(gap_), numbers_);
  const std::vector<Cluster> sampled = sample(depths, pixels, frame);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sampled.size(); ++i)
    if (pixels[i] >= min_pixels_ && count_ + order.size() < std::numeric_limits<std::uint16_t>::max())
      order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return pixels[a] > pixels[b]; });
  std::vector<std::uint16_t> numbers(pixels.size() + 1, 0);
  std::vector<TableObject> objects;
  for (const std::size_t i : order)
  {
    numbers[i + 1] = static_cast<std::uint16_t>(++count_);
    objects.push_back(objectOf(sampled[i], frame));
  }
  label(numbers);
  return objects;
}

/// Places and heights of some pixels of those clusters that are large enough.
std::vector<TableObjects::Cluster> TableObjects::sample(const cv::Mat& depths, const std::vector<int>& pixels,
                                                        const TableFrame& frame) const
{
  std::vector<Cluster> result(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    result[i].step = std::max(1, pixels[i] / kMaxSamples);
  for (int y = 0; y < depths.rows; ++y)
  {
    const auto* const of_clusters = numbers_.ptr<std::int32_t>(y);
    for (int x = 0; x < depths.cols; ++x)
    {
      const auto number = static_cast<std::size_t>(of_clusters[x]);
      if (number == 0 || pixels[number - 1] < min_pixels_) continue;
      Cluster& cluster = result[number - 1];
      cluster.box |= cv::Rect(x, y, 1, 1);
      if (cluster.pixels++ % cluster.step != 0) continue;
      const cv::Vec3d ray(rays_.x.at<float>(y, x), rays_.y.at<float>(y, x), 1.0);
      const cv::Vec3d place = frame.local(static_cast<double>(depths.at<float>(y, x)) * ray);
      cluster.samples.emplace_back(static_cast<float>(place[0]), static_cast<float>(place[1]));
      cluster.heights.push_back(static_cast<float>(place[2]));
    }
  }
  return result;
}

/// Writes the numbers of objects by those of their clusters, 0 for none.
void TableObjects::label(const std::vector<std::uint16_t>& numbers)
{
  for (int y = 0; y < labels_.rows; ++y)
  {
    const auto* const of_clusters = numbers_.ptr<std::int32_t>(y);
    auto* const to = labels_.ptr<std::uint16_t>(y);
    for (int x = 0; x < labels_.cols; ++x)
      if (const std::uint16_t number = numbers[static_cast<std::size_t>(of_clusters[x])]) to[x] = number;
  }
}

TableObject TableObjects::objectOf(const Cluster& cluster, const TableFrame& frame)
{
  std::vector<float> heights = cluster.heights;
  const auto top = heights.begin() + static_cast<std::ptrdiff_t>(kTopShare * static_cast<double>(heights.size() - 1));
  std::nth_element(heights.begin(), top, heights.end());
  const Footprint around = footprint(cluster.samples);
  TableObject object;
  object.box = cluster.box;
  object.pixels = cluster.pixels;
  object.size = {around.length, around.width, *top};
  object.pose = frame.poseOf(around, 0.5 * *top);
  return object;
}

}  // namespace robot_vision
