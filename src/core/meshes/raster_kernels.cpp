#include "raster_kernels.hpp"

#include <cfloat>

namespace robot_vision
{
namespace
{

constexpr int kLanes = Raster::kLanes;
constexpr float kJustBelow = -1e-37F;  // greater than no float below 0 that the weights of a side can have

struct Vector
{
  double x;
  double y;
  double w;
};

inline Vector cross(const SeenVertex& a, const SeenVertex& b)
{
  return {a.y * b.w - a.w * b.y, a.w * b.x - a.x * b.w, a.x * b.y - a.y * b.x};
}

/// A linear function of the ray: x, y and 1 times these.
struct Linear
{
  float x;
  float y;
  float one;
};

/// A triangle, ready to be drawn.
struct Drawing
{
  Linear sides[3];
  float above[3];                // what the weight of each side is above in the triangle
  Linear inverse;                // 1/w
  float low, high;               // of 1/w at its corners, which bound it against rounding
  float nearest;                 // 1/w above this is not drawn
  int left, right, top, bottom;  // the pixels it may touch, all inclusive
};

template <class T>
inline T least(T a, T b, T c)
{
  const T ab = a < b ? a : b;
  return ab < c ? ab : c;
}

template <class T>
inline T greatest(T a, T b, T c)
{
  const T ab = a > b ? a : b;
  return ab > c ? ab : c;
}

/// The pixels from `low` to `high`, of those from 0 to count - 1; none if first > last.
inline void pixelRange(float low, float high, int count, int& first, int& last)
{
  const auto end = static_cast<float>(count);
  const float from = low > 0.0F ? low : 0.0F, to = high < end ? high : end - 1.0F;
  // Numbers that are not negative are rounded down by the conversion.
  first = from < end ? static_cast<int>(from) : count;
  first += static_cast<float>(first) < from;
  last = to < 0.0F ? -1 : static_cast<int>(to);
}

/// The smallest box around what the triangle covers; returns false if there is nothing in it.
inline bool placeInRaster(const SeenVertex& a, const SeenVertex& b, const SeenVertex& c, const SeenTriangles& triangles,
                          const Raster& raster, Drawing& drawing)
{
  const double near = least(a.w, b.w, c.w), far = greatest(a.w, b.w, c.w);
  if (near < triangles.nearest)
  {
    drawing.left = drawing.top = 0;  // it may be anywhere
    drawing.right = raster.columns - 1;
    drawing.bottom = raster.rows - 1;
    drawing.low = 0.0F;
    drawing.high = FLT_MAX;
    return far >= triangles.nearest;
  }
  const float min_u = least(a.u, b.u, c.u), max_u = greatest(a.u, b.u, c.u);
  const float min_v = least(a.v, b.v, c.v), max_v = greatest(a.v, b.v, c.v);
  const float size = max_u - min_u > max_v - min_v ? max_u - min_u : max_v - min_v;
  const float margin = triangles.margin + triangles.bend * size * size;
  const auto left = static_cast<float>(raster.left), top = static_cast<float>(raster.top);
  pixelRange(min_u - margin - left, max_u + margin - left, raster.columns, drawing.left, drawing.right);
  pixelRange(min_v - margin - top, max_v + margin - top, raster.rows, drawing.top, drawing.bottom);
  if (drawing.left > drawing.right || drawing.top > drawing.bottom) return false;
  drawing.low = static_cast<float>(1.0 / far);
  drawing.high = static_cast<float>(1.0 / near);
  return true;
}

inline Linear linear(const Vector& p, double factor)
{
  return {static_cast<float>(p.x * factor), static_cast<float>(p.y * factor), static_cast<float>(p.w * factor)};
}

/// The two triangles of a side get the same numbers for it, with opposite signs: products and differences are rounded
/// the same in any order. A pixel that is exactly on a side or a corner is of the triangle that is a little to the
/// right of it, or below: of one alone. Returns false for a triangle that is seen from the side.
inline bool prepare(const SeenVertex& a, const SeenVertex& b, const SeenVertex& c, Drawing& drawing)
{
  const Vector sides[3] = {cross(b, c), cross(c, a), cross(a, b)};
  const Vector plane = {sides[0].x + sides[1].x + sides[2].x, sides[0].y + sides[1].y + sides[2].y,
                        sides[0].w + sides[1].w + sides[2].w};
  const double volume = a.x * sides[0].x + a.y * sides[0].y + a.w * sides[0].w;
  if (volume == 0.0) return false;
  drawing.inverse = linear(plane, 1.0 / volume);
  const double sign = volume > 0.0 ? 1.0 : -1.0;
  for (int i = 0; i < 3; ++i)
  {
    const Linear inwards = linear(sides[i], sign);
    const bool right = (inwards.x > 0.0F) | ((inwards.x == 0.0F) & (inwards.y > 0.0F));
    drawing.sides[i] = inwards;
    drawing.above[i] = right ? kJustBelow : 0.0F;
  }
  return true;
}

/// The rest of the weights for one row without distortion.
struct RowOffsets
{
  float sides[3];
  float inverse;
};

/// Draws kLanes pixels. For the compiler to make vectors of it, all lanes are computed and written.
template <bool kLens>
inline void drawLanes(const Drawing& d, const RowOffsets& row, const float* __restrict xs, const float* __restrict ys,
                      int index, float* __restrict inverse, int* __restrict drawn)
{
  for (int i = 0; i < kLanes; ++i)
  {
    const float x = xs[i];
    float e0, e1, e2, w;
    if (kLens)
    {
      const float y = ys[i];
      e0 = d.sides[0].x * x + (d.sides[0].y * y + d.sides[0].one);
      e1 = d.sides[1].x * x + (d.sides[1].y * y + d.sides[1].one);
      e2 = d.sides[2].x * x + (d.sides[2].y * y + d.sides[2].one);
      w = d.inverse.x * x + (d.inverse.y * y + d.inverse.one);
    }
    else
    {
      e0 = d.sides[0].x * x + row.sides[0];
      e1 = d.sides[1].x * x + row.sides[1];
      e2 = d.sides[2].x * x + row.sides[2];
      w = d.inverse.x * x + row.inverse;
    }
    const float bounded_below = w > d.low ? w : d.low;
    const float bounded = bounded_below < d.high ? bounded_below : d.high;
    const float before = inverse[i];
    const bool inside =
        (e0 > d.above[0]) & (e1 > d.above[1]) & (e2 > d.above[2]) & (bounded > before) & (bounded <= d.nearest);
    inverse[i] = inside ? bounded : before;
    drawn[i] = inside ? index : drawn[i];
  }
}

inline RowOffsets rowOffsets(const Drawing& d, float y)
{
  return {{d.sides[0].y * y + d.sides[0].one, d.sides[1].y * y + d.sides[1].one, d.sides[2].y * y + d.sides[2].one},
          d.inverse.y * y + d.inverse.one};
}

/// Of a row without distortion that begins at the pixel `first`, the pixels that the triangle may cover. A margin of a
/// pixel is for rounding.
inline void narrow(const Drawing& d, const RowOffsets& row, float first, int& left, int& right)
{
  float from = static_cast<float>(left), to = static_cast<float>(right);
  for (int i = 0; i < 3; ++i)
  {
    const float slope = d.sides[i].x;
    if (slope == 0.0F) continue;
    const float zero = -row.sides[i] / slope - first;
    if (slope > 0.0F && zero - 1.0F > from) from = zero - 1.0F;
    if (slope < 0.0F && zero + 1.0F < to) to = zero + 1.0F;
  }
  const bool none = !(from <= to);
  left = none ? 1 : static_cast<int>(from);
  right = none ? 0 : static_cast<int>(to);
}

template <bool kLens>
inline void drawRows(const Drawing& drawing, int index, const Raster& raster)
{
  const bool wide = drawing.right - drawing.left > 2 * kLanes;
  for (int row = drawing.top; row <= drawing.bottom; ++row)
  {
    int left = drawing.left, right = drawing.right;
    const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(row) * raster.columns;
    RowOffsets offsets = {};
    if (!kLens)
    {
      offsets = rowOffsets(drawing, static_cast<float>(raster.top + row));
      if (wide) narrow(drawing, offsets, static_cast<float>(raster.left), left, right);
    }
    const float* xs = raster.xs + row * raster.ray_step;
    const float* ys = kLens ? raster.ys + row * raster.ray_step : nullptr;
    for (int column = left / kLanes * kLanes; column <= right; column += kLanes)
      drawLanes<kLens>(drawing, offsets, xs + column, kLens ? ys + column : nullptr, index,
                       raster.inverse + begin + column, raster.drawn + begin + column);
  }
}

void draw(const SeenVertex* vertices, const SeenTriangles& triangles, const Raster& raster)
{
  Drawing drawing;
  drawing.nearest = static_cast<float>(1.0 / triangles.nearest);
  for (int index = 0; index < triangles.count; ++index)
  {
    const int* corners = triangles.corners + 3 * static_cast<std::ptrdiff_t>(triangles.drawn[index]);
    const SeenVertex &a = vertices[corners[0]], &b = vertices[corners[1]], &c = vertices[corners[2]];
    if (!placeInRaster(a, b, c, triangles, raster, drawing)) continue;
    if (!prepare(a, b, c, drawing)) continue;
    if (raster.ys != nullptr)
      drawRows<true>(drawing, index, raster);
    else
      drawRows<false>(drawing, index, raster);
  }
}

}  // namespace

template <>
const RasterKernels KernelTable<RasterKernels, ROBOT_VISION_SET>::table = {draw};

}  // namespace robot_vision
