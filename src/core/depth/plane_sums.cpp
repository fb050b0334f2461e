#include "plane_sums.hpp"

#include <algorithm>

namespace robot_vision
{
namespace
{

constexpr double kMinSpread = 1e-9;     // of the determinant, in the product of both variances
constexpr double kMinVariance = 1e-12;  // of rays, in the mean of their squares: less is what rounding leaves of none

}  // namespace

PlaneSums& PlaneSums::operator+=(const PlaneSums& other)
{
  n += other.n;
  x += other.x;
  y += other.y;
  w += other.w;
  xx += other.xx;
  xy += other.xy;
  yy += other.yy;
  xw += other.xw;
  yw += other.yw;
  ww += other.ww;
  return *this;
}

std::optional<InversePlane> PlaneSums::fit() const
{
  if (n < 3.0) return std::nullopt;
  const double mx = x / n, my = y / n, mw = w / n;
  const double cxx = xx / n - mx * mx, cxy = xy / n - mx * my, cyy = yy / n - my * my;
  const double cxw = xw / n - mx * mw, cyw = yw / n - my * mw;
  if (cxx <= kMinVariance * xx / n || cyy <= kMinVariance * yy / n) return std::nullopt;
  const double det = cxx * cyy - cxy * cxy;
  if (!(det > kMinSpread * cxx * cyy)) return std::nullopt;
  InversePlane plane;
  plane.a = (cxw * cyy - cyw * cxy) / det;
  plane.b = (cyw * cxx - cxw * cxy) / det;
  plane.c = mw - plane.a * mx - plane.b * my;
  return plane;
}

double PlaneSums::meanSquare(const InversePlane& p) const
{
  const double of_plane =
      p.a * (p.a * xx + 2.0 * (p.b * xy + p.c * x)) + p.b * (p.b * yy + 2.0 * p.c * y) + p.c * p.c * n;
  const double of_both = p.a * xw + p.b * yw + p.c * w;
  return std::max(0.0, (ww - 2.0 * of_both + of_plane) / n);
}

}  // namespace robot_vision
