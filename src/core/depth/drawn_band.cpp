#include "drawn_band.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr int kMargin = kMaxCellSide - 1;  // px
constexpr int kSampled = 16;               // of so many cells one tells how large they are

Vertex vertexAt(const VertexRow& row, int i)
{
  return {row.u[i], row.v[i], row.w[i]};
}

VertexRow from(const VertexRow& row, int i)
{
  return {row.u + i, row.v + i, row.w + i};
}

/// A line from p to q. What it gives for a pixel is exact: 0 on it, above 0 to the right of it, where v points down.
class Line
{
public:
  Line(const Vertex& p, const Vertex& q) : p_(p), du_(q.u - p.u), dv_(q.v - p.v) {}

  std::int64_t at(std::int64_t x, std::int64_t y) const
  {
    return du_ * (y * kSubpixels - p_.v) - dv_ * (x * kSubpixels - p_.u);
  }

  /// What it changes by from one pixel to the next on the right.
  std::int64_t step() const { return -dv_ * kSubpixels; }

private:
  Vertex p_;
  std::int64_t du_, dv_;
};

/// The pixel centres between two positions, as a range.
cv::Range centres(std::int32_t low, std::int32_t high, const cv::Range& within)
{
  return {std::max(within.start, (low + (kSubpixels - 1)) >> kSubpixelBits),
          std::min(within.end, (high >> kSubpixelBits) + 1)};
}

}  // namespace

void DrawnBand::reset(int width, const cv::Range& rows, float max_ratio, const HalfCell& half)
{
  pixels_.create(rows.size() + 2 * kMargin, width + 2 * kMargin, CV_32FC1);
  pixels_.setTo(0.0);
  rows_ = {width, rows.start, rows.end, static_cast<int>(pixels_.step1()), kMargin, max_ratio};
  half_ = half;
}

void DrawnBand::draw(const VertexRow& upper, const VertexRow& lower, int cells)
{
  switch (sideOf(upper, lower, cells))
  {
    case 2:
      return draw<2>(upper, lower, cells);
    case 3:
      return draw<3>(upper, lower, cells);
    default:
      return draw<4>(upper, lower, cells);
  }
}

/// The pixel centres that cells of this row have in one direction, as some of them have.
int DrawnBand::sideOf(const VertexRow& upper, const VertexRow& lower, int cells) const
{
  int side = kMinCellSide;
  for (int i = 0; i < cells; i += kSampled)
  {
    const Vertex a = vertexAt(upper, i), b = vertexAt(upper, i + 1), c = vertexAt(lower, i), d = vertexAt(lower, i + 1);
    if (!isSurface(a, b, d) || !isSurface(a, d, c)) continue;
    const auto [left, right] = std::minmax({a.u, b.u, c.u, d.u});
    const auto [top, bottom] = std::minmax({a.v, b.v, c.v, d.v});
    side = std::max(side, (std::max(right - left, bottom - top) >> kSubpixelBits) + 1);
  }
  return side;
}

template <int kSide>
void DrawnBand::draw(const VertexRow& upper, const VertexRow& lower, int cells)
{
  const auto kernel = kernels<CellKernels>().draw[kSide - kMinCellSide];
  std::array<std::int32_t, kCellsAtOnce> index;
  std::array<float, kSide * kSide * kCellsAtOnce> values;
  for (int first = 0; first < cells; first += kCellsAtOnce)
  {
    const int count = std::min(kCellsAtOnce, cells - first);
    kernel(from(upper, first), from(lower, first), rows_, count, index.data(), values.data());
    for (int i = 0; i < count; ++i)
    {
      const int at = first + i;
      if (index[i] >= 0)
        add<kSide>(index[i], &values[i]);
      else if (index[i] == kOtherCell)
        drawCell({vertexAt(upper, at), vertexAt(upper, at + 1), vertexAt(lower, at + 1), vertexAt(lower, at)});
    }
  }
}

/// Draws the pixels of a cell that the kernel has found.
template <int kSide>
void DrawnBand::add(int offset, const float* values)
{
  auto* pixels = pixels_.ptr<float>() + offset;
  for (int y = 0; y < kSide; ++y, pixels += rows_.stride)
    for (int x = 0; x < kSide; ++x, values += kCellsAtOnce)
      pixels[x] = std::max(pixels[x], *values);
}

bool DrawnBand::isSurface(const Vertex& a, const Vertex& b, const Vertex& c) const
{
  const auto [farthest, nearest] = std::minmax({a.w, b.w, c.w});
  return farthest > 0.0F && farthest * rows_.max_ratio >= nearest;
}

void DrawnBand::drawCell(const Cell& cell)
{
  const bool falls = std::abs(cell[0].w - cell[2].w) <= std::abs(cell[1].w - cell[3].w);
  const std::size_t begin = falls ? 0 : 1;
  const auto corner = [begin](std::size_t i) { return (begin + i) % 4; };
  const Vertex &p0 = cell[corner(0)], &p1 = cell[corner(1)], &p2 = cell[corner(2)], &p3 = cell[corner(3)];
  const bool first = isSurface(p0, p1, p2), second = isSurface(p0, p2, p3);
  if (first) drawTriangle(p0, p1, p2);
  if (second) drawTriangle(p0, p2, p3);
  const std::array<bool, 4> in_triangle = {first || second, first, first || second, second};
  for (std::size_t i = 0; i < 4; ++i)
    if (!in_triangle[i] && cell[corner(i)].w > 0.0F) drawQuarter(cell[corner(i)], static_cast<int>(corner(i)));
}

/// Draws the part of a cell that is nearest to a vertex at one of its corners.
void DrawnBand::drawQuarter(const Vertex& vertex, int corner)
{
  const bool is_left = corner == 0 || corner == 3, is_upper = corner < 2;
  const cv::Point across = is_left ? half_.right : -half_.right, along = is_upper ? half_.down : -half_.down;
  const auto moved = [&vertex](const cv::Point& by) { return Vertex{vertex.u + by.x, vertex.v + by.y, vertex.w}; };
  const Vertex opposite = moved(across + along);
  Vertex second = moved(across), fourth = moved(along);
  if (is_left != is_upper) std::swap(second, fourth);  // clockwise
  drawTriangle(vertex, second, opposite);
  drawTriangle(vertex, opposite, fourth);
}

void DrawnBand::drawTriangle(const Vertex& a, const Vertex& b, const Vertex& c)
{
  const auto [left, right] = std::minmax({a.u, b.u, c.u});
  const auto [top, bottom] = std::minmax({a.v, b.v, c.v});
  const cv::Range columns = centres(left, right, {0, rows_.width}),
                  rows = centres(top, bottom, {rows_.begin, rows_.end});
  if (columns.start >= columns.end || rows.start >= rows.end) return;
  const Line ab(a, b), bc(b, c), ca(c, a);
  const std::int64_t area = ab.at(0, 0) + bc.at(0, 0) + ca.at(0, 0);  // twice; the same for every pixel
  if (area <= 0) return;
  const double per_area = 1.0 / static_cast<double>(area);
  for (int y = rows.start; y < rows.end; ++y)
  {
    auto* const pixels = pixels_.ptr<float>(y - rows_.begin + kMargin) + kMargin;
    std::int64_t of_c = ab.at(columns.start, y), of_a = bc.at(columns.start, y), of_b = ca.at(columns.start, y);
    for (int x = columns.start; x < columns.end; ++x, of_c += ab.step(), of_a += bc.step(), of_b += ca.step())
    {
      if ((of_a | of_b | of_c) < 0) continue;
      const double w =
          static_cast<double>(of_a) * a.w + static_cast<double>(of_b) * b.w + static_cast<double>(of_c) * c.w;
      pixels[x] = std::max(pixels[x], static_cast<float>(w * per_area));
    }
  }
}

}  // namespace robot_vision
