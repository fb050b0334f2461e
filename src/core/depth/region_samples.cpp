#include "region_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include "depth_layers.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxSamples = 1000.0;
constexpr float kMetresPerMm = 0.001F;

/// Where an outline crosses the middle of a row of pixels.
struct Crossing
{
  int y;
  double x;

  bool operator<(const Crossing& other) const { return std::tie(y, x) < std::tie(other.y, other.x); }
};

/// Pixels from `begin` to before `end` of a row.
struct Span
{
  int y;
  int begin;
  int end;
};

double areaOf(const std::vector<cv::Point2d>& outline)
{
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    twice += (outline[i] - outline[0]).cross(outline[(i + 1) % outline.size()] - outline[0]);
  return std::abs(twice) / 2.0;
}

/// Rows and columns of pixels at equal distances.
struct Grid
{
  cv::Rect part;  // px, of the image
  int stride;     // px

  int left() const { return part.x + std::min(stride, part.width) / 2; }
  int top() const { return part.y + std::min(stride, part.height) / 2; }

  /// The first row or column from `from` on, of those that begin with `first`.
  int next(int first, int from) const { return first + std::max(0, (from - first + stride - 1) / stride) * stride; }
};

/// Adds where the line from a to b crosses rows: also at its upper end, but not at its lower end.
void addCrossings(cv::Point2d a, cv::Point2d b, const Grid& grid, std::vector<Crossing>& crossings)
{
  if (a.y > b.y) std::swap(a, b);
  const double top = grid.part.y, bottom = grid.part.br().y;
  const int first = static_cast<int>(std::clamp(std::ceil(a.y), top, bottom));
  const int end = static_cast<int>(std::clamp(std::ceil(b.y), top, bottom));
  for (int y = grid.next(grid.top(), first); y < end; y += grid.stride)
    crossings.push_back({y, a.x + (y - a.y) * ((b.x - a.x) / (b.y - a.y))});
}

std::vector<Span> spansOf(const Grid& grid, const std::vector<cv::Point2d>& outline)
{
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < outline.size(); ++i)
    addCrossings(outline[i], outline[(i + 1) % outline.size()], grid, crossings);
  std::sort(crossings.begin(), crossings.end());
  std::vector<Span> spans;
  const double left = grid.part.x, right = grid.part.br().x;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)  // a closed outline crosses a row an even number of times
  {
    const double begin = std::clamp(std::ceil(crossings[i].x), left, right);
    const double end = std::clamp(std::floor(crossings[i + 1].x) + 1.0, left, right);
    spans.push_back({crossings[i].y, static_cast<int>(begin), static_cast<int>(end)});
  }
  return spans;
}

std::vector<Span> spansOf(const Grid& grid)
{
  std::vector<Span> spans;
  for (int y = grid.top(); y < grid.part.br().y; y += grid.stride)
    spans.push_back({y, grid.part.x, grid.part.br().x});
  return spans;
}

/// How much a place counts that is this share of the way through a side of the box.
double weightAt(double share)
{
  const double off = 2.0 * share - 1.0;
  return std::max(1.0 - off * off, 0.0);
}

template <class Value>
void addSamples(const cv::Mat& depth, const cv::Rect& box, const Grid& grid, const std::vector<Span>& spans,
                float metres, std::vector<RegionSample>& samples)
{
  for (const Span& span : spans)
  {
    const auto* const row = depth.ptr<Value>(span.y);
    const double weight = weightAt((span.y + 0.5 - box.y) / box.height);
    for (int x = grid.next(grid.left(), span.begin); x < span.end; x += grid.stride)
    {
      const float z = static_cast<float>(row[x]) * metres;
      if (!(z > 0.0F && z <= kMaxLayerDepth)) continue;
      samples.push_back({x, span.y, z, static_cast<float>(weight * weightAt((x + 0.5 - box.x) / box.width))});
    }
  }
}

}  // namespace

RegionSamples samplesOf(const cv::Mat& depth, const cv::Rect& box, const std::vector<cv::Point2d>& outline)
{
  const cv::Rect part = box & cv::Rect(0, 0, depth.cols, depth.rows);
  const double all = part.area(), inside = areaOf(outline);
  const double area = inside >= 1.0 ? std::min(inside, all) : all;
  RegionSamples found;
  found.stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(area / kMaxSamples))));
  const Grid grid = {part, found.stride};
  const std::vector<Span> spans = inside >= 1.0 ? spansOf(grid, outline) : spansOf(grid);
  if (depth.type() == CV_16UC1)
    addSamples<std::uint16_t>(depth, box, grid, spans, kMetresPerMm, found.samples);
  else
    addSamples<float>(depth, box, grid, spans, 1.0F, found.samples);
  return found;
}

}  // namespace robot_vision
