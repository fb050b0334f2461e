#pragma once

#include <optional>

namespace robot_vision
{

/// A plane by the inverse depths w = a x + b y + c that it has at the rays (x, y, 1) of a camera: a, b and c are its
/// normal divided by its distance from the camera, 1/m.
struct InversePlane
{
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;

  double at(double x, double y) const { return a * x + b * y + c; }
};

/// Sums over pixels with a ray (x, y, 1) and an inverse depth w (1/m), of which planes are made.
struct PlaneSums
{
  double n = 0.0, x = 0.0, y = 0.0, w = 0.0;
  double xx = 0.0, xy = 0.0, yy = 0.0, xw = 0.0, yw = 0.0, ww = 0.0;

  void add(double ray_x, double ray_y, double inverse_depth)
  {
    n += 1.0;
    x += ray_x;
    y += ray_y;
    w += inverse_depth;
    xx += ray_x * ray_x;
    xy += ray_x * ray_y;
    yy += ray_y * ray_y;
    xw += ray_x * inverse_depth;
    yw += ray_y * inverse_depth;
    ww += inverse_depth * inverse_depth;
  }

  PlaneSums& operator+=(const PlaneSums& other);

  /// The plane with the least squared error of w; none if the pixels are fewer than three or in one line.
  std::optional<InversePlane> fit() const;

  /// The mean of the squared errors of w with regard to a plane, 1/m^2.
  double meanSquare(const InversePlane& plane) const;
};

}  // namespace robot_vision
