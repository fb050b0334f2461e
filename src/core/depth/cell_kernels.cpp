#include "cell_kernels.hpp"

#include <cstdint>
#include <utility>

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

ROBOT_VISION_INLINE float distance(float a, float b)
{
  return greater(a, b) - lesser(a, b);
}

/// A vertex, in steps from the first pixel of its cell. All of these are whole numbers, and so small that products and
/// sums of them are exact.
struct Corner
{
  float x, y, w;
};

/// A line from p to q: what at() gives is 0 on it, and above 0 to the right of it, where y points down.
struct Edge
{
  float dx, dy, first;

  ROBOT_VISION_INLINE float at(float x, float y) const { return first + dx * y - dy * x; }
};

ROBOT_VISION_INLINE Edge edge(const Corner& p, const Corner& q)
{
  const float dx = q.x - p.x, dy = q.y - p.y;
  return {dx, dy, dy * p.x - dx * p.y};
}

/// The triangles 0 1 2 and 0 2 3 of a cell, whose corners go clockwise.
struct Halves
{
  Edge e01, e12, e20, e23, e30;
  float w0, w1, w2, w3;
  bool first, second;        // whether they are drawn
  float inverse1, inverse2;  // of twice their areas
};

ROBOT_VISION_INLINE Halves halves(const Corner& p0, const Corner& p1, const Corner& p2, const Corner& p3, bool drawn)
{
  const Edge e01 = edge(p0, p1), e12 = edge(p1, p2), e20 = edge(p2, p0), e23 = edge(p2, p3), e30 = edge(p3, p0);
  const float area1 = e01.first + e12.first + e20.first, area2 = e23.first + e30.first - e20.first;
  const bool front1 = area1 > 0.0F, front2 = area2 > 0.0F;
  const bool first = drawn & front1, second = drawn & front2;
  const float inverse1 = 1.0F / (front1 ? area1 : 1.0F), inverse2 = 1.0F / (front2 ? area2 : 1.0F);
  return {e01, e12, e20, e23, e30, p0.w, p1.w, p2.w, p3.w, first, second, inverse1, inverse2};
}

/// The inverse depth of a cell at a pixel, in steps from its first one; 0 where the cell is not.
ROBOT_VISION_INLINE float valueAt(const Halves& cell, float x, float y)
{
  const float a01 = cell.e01.at(x, y), a12 = cell.e12.at(x, y), a20 = cell.e20.at(x, y);
  const float a23 = cell.e23.at(x, y), a30 = cell.e30.at(x, y);
  const bool in_first = cell.first & (lesser(lesser(a01, a12), a20) >= 0.0F);
  const bool in_second = cell.second & (lesser(lesser(a23, a30), -a20) >= 0.0F);
  const float first = (a12 * cell.w0 + a20 * cell.w1 + a01 * cell.w2) * cell.inverse1;
  const float second = (a23 * cell.w0 + a30 * cell.w2 - a20 * cell.w3) * cell.inverse2;
  return in_first ? first : (in_second ? second : 0.0F);
}

/// Straight code for all pixels of a cell: a loop inside the one over the cells would keep that from making vectors.
template <int kSide, int... kPixels>
ROBOT_VISION_INLINE void writeCell(const Halves& cell, std::integer_sequence<int, kPixels...> /*pixels*/, float* values)
{
  ((values[kPixels * kCellsAtOnce] = valueAt(cell, static_cast<float>(kPixels % kSide * kSubpixels),
                                             static_cast<float>(kPixels / kSide * kSubpixels))),
   ...);
}

template <int kSide>
void drawCells(const VertexRow& upper, const VertexRow& lower, const DrawnRows& rows, int count,
               std::int32_t* __restrict index, float* __restrict values)
{
  const VertexRow above = upper, below = lower;
  const DrawnRows to = rows;
  for (int i = 0; i < count; ++i)
  {
    const std::int32_t ua = above.u[i], ub = above.u[i + 1], uc = below.u[i], ud = below.u[i + 1];
    const std::int32_t va = above.v[i], vb = above.v[i + 1], vc = below.v[i], vd = below.v[i + 1];
    const float wa = above.w[i], wb = above.w[i + 1], wc = below.w[i], wd = below.w[i + 1];
    const float farthest = lesser(lesser(wa, wb), lesser(wc, wd));
    const float nearest = greater(greater(wa, wb), greater(wc, wd));
    const bool smooth = (farthest > 0.0F) & (farthest * to.max_ratio >= nearest);

    // The pixel centres in the rectangle around it: from left to right and top to bottom, with both.
    const std::int32_t left = (lesser(lesser(ua, ub), lesser(uc, ud)) + (kSubpixels - 1)) >> kSubpixelBits;
    const std::int32_t right = greater(greater(ua, ub), greater(uc, ud)) >> kSubpixelBits;
    const std::int32_t top = (lesser(lesser(va, vb), lesser(vc, vd)) + (kSubpixels - 1)) >> kSubpixelBits;
    const std::int32_t bottom = greater(greater(va, vb), greater(vc, vd)) >> kSubpixelBits;
    const bool small = (right - left < kSide) & (bottom - top < kSide);
    const bool here = (right >= 0) & (left < to.width) & (bottom >= to.begin) & (top < to.end);
    const bool drawn = smooth & small & here;
    const bool other = (smooth & !small & here) | (!smooth & (nearest > 0.0F));
    const std::int32_t offset = (top - to.begin + to.margin) * to.stride + left + to.margin;
    index[i] = drawn ? offset : (other ? kOtherCell : kNoCell);

    const std::int32_t x = left * kSubpixels, y = top * kSubpixels;
    const Corner a{static_cast<float>(ua - x), static_cast<float>(va - y), wa};
    const Corner b{static_cast<float>(ub - x), static_cast<float>(vb - y), wb};
    const Corner c{static_cast<float>(uc - x), static_cast<float>(vc - y), wc};
    const Corner d{static_cast<float>(ud - x), static_cast<float>(vd - y), wd};
    const bool falls = distance(wa, wd) <= distance(wb, wc);  // the diagonal from top left to bottom right
    const Corner p0{falls ? a.x : b.x, falls ? a.y : b.y, falls ? a.w : b.w};
    const Corner p1{falls ? b.x : d.x, falls ? b.y : d.y, falls ? b.w : d.w};
    const Corner p2{falls ? d.x : c.x, falls ? d.y : c.y, falls ? d.w : c.w};
    const Corner p3{falls ? c.x : a.x, falls ? c.y : a.y, falls ? c.w : a.w};
    writeCell<kSide>(halves(p0, p1, p2, p3, drawn), std::make_integer_sequence<int, kSide * kSide>(), values + i);
  }
}

void metresOf(const float* inverses, int count, float* __restrict metres)
{
  for (int i = 0; i < count; ++i)
  {
    const bool seen = inverses[i] > 0.0F;
    metres[i] = valueIf(seen, 1.0F / (seen ? inverses[i] : 1.0F));
  }
}

void millimetresOf(const float* inverses, int count, std::uint16_t* __restrict millimetres)
{
  constexpr float kBeyond = 65536.0F;
  for (int i = 0; i < count; ++i)
  {
    const bool seen = inverses[i] > 0.0F;
    const float metres = 1.0F / (seen ? inverses[i] : 1.0F), rounded = metres * 1000.0F + 0.5F;
    const float limited = seen & (rounded < kBeyond) ? rounded : 0.0F;
    millimetres[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(limited));
  }
}

}  // namespace

template <>
const CellKernels KernelTable<CellKernels, ROBOT_VISION_SET>::table = {
    {drawCells<2>, drawCells<3>, drawCells<4>},
    metresOf,
    millimetresOf,
};

}  // namespace robot_vision
