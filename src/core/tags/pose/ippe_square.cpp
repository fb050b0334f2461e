#include "ippe_square.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{

namespace
{

/// A rotation that takes the z axis to (x, y, 1).
cv::Matx33d turnTowards(const cv::Point2d& v)
{
  const double distance = std::hypot(v.x, v.y), tiny = 1e-12;
  if (distance < tiny) return cv::Matx33d::eye();
  const double angle = std::atan(distance);
  return cv::Affine3d(cv::Vec3d(-v.y, v.x, 0.0) * (angle / distance)).rotation();
}

}  // namespace

cv::Matx33d fromUnitSquare(const std::array<cv::Point2d, 4>& p)
{
  const cv::Point2d sum = p[0] - p[1] + p[2] - p[3], a = p[1] - p[2], b = p[3] - p[2];
  const double det = a.cross(b), g = sum.cross(b) / det, h = a.cross(sum) / det;
  const cv::Point2d u = p[1] - p[0] + g * p[1], v = p[3] - p[0] + h * p[3];
  return {u.x, v.x, p[0].x, u.y, v.y, p[0].y, g, h, 1.0};
}

std::array<cv::Affine3d, 2> squarePoses(const std::array<cv::Point2d, 4>& rays, double size)
{
  // The image of the square's middle, and the derivatives of the image there by x and y of the square.
  const cv::Matx33d H = fromUnitSquare(rays);
  const cv::Vec3d middle = H * cv::Vec3d(0.5, 0.5, 1.0);
  const cv::Point2d v(middle[0] / middle[2], middle[1] / middle[2]);
  const double scale = middle[2] * size;
  const cv::Matx22d J((H(0, 0) - v.x * H(2, 0)) / scale, (H(0, 1) - v.x * H(2, 1)) / scale,
                      (H(1, 0) - v.y * H(2, 0)) / scale, (H(1, 1) - v.y * H(2, 1)) / scale);

  // The same as seen along the ray to the middle gives two rows of the rotation, divided by the distance along z.
  const cv::Matx33d view = turnTowards(v);
  const cv::Matx23d perspective(1.0, 0.0, -v.x, 0.0, 1.0, -v.y);
  const cv::Matx<double, 2, 2> across = (perspective * view).get_minor<2, 2>(0, 0);
  const cv::Matx22d A = across.inv() * J;
  const double squares = A.dot(A), det = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  const double largest = std::sqrt((squares + std::sqrt(std::max(0.0, squares * squares - 4.0 * det * det))) / 2.0);
  const cv::Vec2d x(A(0, 0) / largest, A(1, 0) / largest), y(A(0, 1) / largest, A(1, 1) / largest);

  // The third row makes the columns orthogonal and of unit length. Its sign is open, which gives the two poses.
  const double x_out = std::sqrt(std::max(0.0, 1.0 - x.dot(x)));
  const double y_out = std::copysign(std::sqrt(std::max(0.0, 1.0 - y.dot(y))), -x.dot(y));
  std::array<cv::Affine3d, 2> poses;
  for (const int sign : {0, 1})
  {
    const double side = sign ? -1.0 : 1.0;
    const cv::Vec3d right(x[0], x[1], side * x_out), up(y[0], y[1], side * y_out), out = right.cross(up);
    const cv::Matx33d seen(right[0], up[0], out[0], right[1], up[1], out[1], right[2], up[2], out[2]);
    poses[static_cast<std::size_t>(sign)] = cv::Affine3d(view * seen, cv::Vec3d(v.x, v.y, 1.0) / largest);
  }
  return poses;
}

}  // namespace robot_vision
