#include "region_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

#include "depth_layers.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxSamples = 1000.0;
constexpr double kMaxLooks = 100000.0;  // at pixels of the box, of which few may be in a thin outline
constexpr float kMetresPerMm = 0.001F;

double areaOf(const std::vector<cv::Point2d>& outline)
{
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    twice += (outline[i] - outline[0]).cross(outline[(i + 1) % outline.size()] - outline[0]);
  return std::abs(twice) / 2.0;
}

/// Pixels at equal distances in rows and columns.
struct Grid
{
  Grid(const cv::Rect& part, int distance)
    : stride(distance),
      left(part.x + std::min(stride, part.width) / 2),
      top(part.y + std::min(stride, part.height) / 2),
      columns((part.br().x - left + stride - 1) / stride),
      rows((part.br().y - top + stride - 1) / stride)
  {
  }

  int stride;  // px
  int left;    // px, of the first column
  int top;     // px, of the first row
  int columns;
  int rows;
};

/// The first of `count` rows or columns that is at or behind a position; `count` if none is.
int firstFrom(double position, int begin, int stride, int count)
{
  return static_cast<int>(std::clamp(std::ceil((position - begin) / stride), 0.0, static_cast<double>(count)));
}

/// Which pixels of a grid are inside of an outline, row by row. Each line of the outline turns what is to the right of
/// it into the opposite.
std::vector<std::uint8_t> insideOf(const Grid& grid, const std::vector<cv::Point2d>& outline)
{
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
  for (std::size_t i = 0; i < outline.size(); ++i)
  {
    cv::Point2d a = outline[i], b = outline[(i + 1) % outline.size()];
    if (a.y > b.y) std::swap(a, b);
    const int end = firstFrom(b.y, grid.top, grid.stride, grid.rows);
    for (int row = firstFrom(a.y, grid.top, grid.stride, grid.rows); row < end; ++row)
    {
      const double share = (grid.top + row * grid.stride - a.y) / (b.y - a.y);
      const int column = firstFrom(a.x + share * (b.x - a.x), grid.left, grid.stride, grid.columns);
      if (column < grid.columns) inside[static_cast<std::size_t>(row * grid.columns + column)] ^= 1U;
    }
  }
  for (int row = 0; row < grid.rows; ++row)
  {
    auto* const first = inside.data() + row * grid.columns;
    std::partial_sum(first, first + grid.columns, first, std::bit_xor<std::uint8_t>());
  }
  return inside;
}

/// How much a place counts that is this share of the way through a side of the box.
double weightAt(double share)
{
  const double off = 2.0 * share - 1.0;
  return std::max(1.0 - off * off, 0.0);
}

/// Adds the pixels that have a depth; `inside` is empty if all count.
template <class Value>
void addSamples(const cv::Mat& depth, const cv::Rect& box, const Grid& grid, const std::vector<std::uint8_t>& inside,
                float metres, std::vector<RegionSample>& samples)
{
  for (int row = 0; row < grid.rows; ++row)
  {
    const int y = grid.top + row * grid.stride;
    const auto* const values = depth.ptr<Value>(y);
    const double weight = weightAt((y + 0.5 - box.y) / box.height);
    for (int column = 0; column < grid.columns; ++column)
    {
      if (!inside.empty() && inside[static_cast<std::size_t>(row * grid.columns + column)] == 0) continue;
      const int x = grid.left + column * grid.stride;
      const float z = static_cast<float>(values[x]) * metres;
      if (!(z > 0.0F && z <= kMaxLayerDepth)) continue;
      samples.push_back({x, y, z, static_cast<float>(weight * weightAt((x + 0.5 - box.x) / box.width))});
    }
  }
}

}  // namespace

RegionSamples samplesOf(const cv::Mat& depth, const cv::Rect& box, const std::vector<cv::Point2d>& outline)
{
  const cv::Rect part = box & cv::Rect(0, 0, depth.cols, depth.rows);
  const double all = part.area(), enclosed = areaOf(outline);
  const bool has_outline = enclosed >= 1.0;
  const double area = has_outline ? std::min(enclosed, all) : all;
  const double square = std::max(area / kMaxSamples, all / kMaxLooks);  // px^2, for each sample
  RegionSamples found;
  found.stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(square))));
  const Grid grid(part, found.stride);
  const std::vector<std::uint8_t> inside = has_outline ? insideOf(grid, outline) : std::vector<std::uint8_t>();
  if (depth.type() == CV_16UC1)
    addSamples<std::uint16_t>(depth, box, grid, inside, kMetresPerMm, found.samples);
  else
    addSamples<float>(depth, box, grid, inside, 1.0F, found.samples);
  return found;
}

}  // namespace robot_vision
