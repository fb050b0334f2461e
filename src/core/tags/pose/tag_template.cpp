#include "tag_template.hpp"

#include <cmath>

#include "ippe_square.hpp"

namespace robot_vision
{

Mapped mapped(const cv::Matx33d& H, const cv::Point2d& point)
{
  const double per_z = 1.0 / (H(2, 0) * point.x + H(2, 1) * point.y + H(2, 2));
  const double x = (H(0, 0) * point.x + H(0, 1) * point.y + H(0, 2)) * per_z;
  const double y = (H(1, 0) * point.x + H(1, 1) * point.y + H(1, 2)) * per_z;
  return {{x, y},
          {(H(0, 0) - x * H(2, 0)) * per_z, (H(0, 1) - x * H(2, 1)) * per_z, (H(1, 0) - y * H(2, 0)) * per_z,
           (H(1, 1) - y * H(2, 1)) * per_z}};
}

cv::Matx33d toTemplate(const std::array<cv::Point2d, 4>& corners, const TagTemplate& tag_template)
{
  const double side = static_cast<double>(tag_template.widthAtBorder()) / tag_template.cells.cols;
  // The rows of the template count downwards.
  const cv::Matx33d to_square(1.0 / side, 0.0, 0.5, 0.0, -1.0 / side, 0.5, 0.0, 0.0, 1.0);
  return (fromUnitSquare(corners) * to_square).inv();
}

std::array<cv::Point2d, 4> templateCorners(const cv::Matx33d& to_template, const TagTemplate& tag_template)
{
  const cv::Matx33d to_image = to_template.inv();
  const double half = 0.5 * tag_template.widthAtBorder() / tag_template.cells.cols;
  return {mapped(to_image, {-half, half}).point, mapped(to_image, {half, half}).point,
          mapped(to_image, {half, -half}).point, mapped(to_image, {-half, -half}).point};
}

TagView movedView(const TagView& view, const Unknowns& by)
{
  const cv::Matx33d motion(1.0 + by[1], by[2], by[0], by[4], 1.0 + by[5], by[3], -by[6], -by[7], 1.0);
  return {motion * view.H, view.appearance + by};
}

double grayAt(const BlurredGrid& cells, int width, const TagView& view, const cv::Point2d& position, Unknowns& jacobian)
{
  const Mapped seen = mapped(view.H, position);
  const cv::Point2d& q = seen.point;
  const cv::Vec2d gx(seen.jacobian(0, 0), seen.jacobian(0, 1)), gy(seen.jacobian(1, 0), seen.jacobian(1, 1));
  const double nx = std::sqrt(gx.dot(gx)), ny = std::sqrt(gy.dot(gy));
  const double blur = view.appearance[kBlur] * width, correlation = gx.dot(gy) / (nx * ny);
  const BlurredPoint point = cells.at((q + cv::Point2d(0.5, 0.5)) * width, {blur * nx, blur * ny}, correlation);

  const auto& appearance = view.appearance;
  const double black = appearance[kBlack] + q.x * appearance[kBlack + 1] + q.y * appearance[kBlack + 2];
  const double contrast = appearance[kContrast] + q.x * appearance[kContrast + 1] + q.y * appearance[kContrast + 2];
  const double around = appearance[kAround], white = point.white.share, outside = 1.0 - point.known.share;
  const cv::Vec2d g = width * (contrast * point.white.by_point - around * point.known.by_point) +
                      cv::Vec2d(appearance[kBlack + 1] + white * appearance[kContrast + 1],
                                appearance[kBlack + 2] + white * appearance[kContrast + 2]);
  const double gq = g[0] * q.x + g[1] * q.y;
  const cv::Vec2d by_sigma = contrast * point.white.by_sigma - around * point.known.by_sigma;
  jacobian = Unknowns(g[0], g[0] * q.x, g[0] * q.y, g[1], g[1] * q.x, g[1] * q.y, gq * q.x, gq * q.y,
                      width * (by_sigma[0] * nx + by_sigma[1] * ny), 1.0, q.x, q.y, white, white * q.x);
  jacobian[kContrast + 2] = white * q.y;
  jacobian[kAround] = outside;

  // The blur in cells also depends on the homography: stretched cells make it smaller, and shear turns its axes.
  const double by_shear =
      (1.0 - correlation * correlation) * (contrast * point.white.by_correlation - around * point.known.by_correlation);
  const double xx = by_sigma[0] * blur * nx, yy = by_sigma[1] * blur * ny;
  const double xy = (correlation * xx + by_shear) * ny / nx, yx = (correlation * yy + by_shear) * nx / ny;
  jacobian[1] += xx;
  jacobian[2] += xy;
  jacobian[4] += yx;
  jacobian[5] += yy;
  jacobian[6] += q.x * (2.0 * xx + yy) + q.y * yx;
  jacobian[7] += q.y * (xx + 2.0 * yy) + q.x * xy;
  return black + contrast * white + around * outside;
}

cv::Matx<double, 8, 8> cornersByHomography(const cv::Matx33d& H, const std::array<cv::Point2d, 4>& corners)
{
  cv::Matx<double, 8, 8> moved;
  for (int i = 0; i < 4; ++i)
  {
    const Mapped corner = mapped(H, corners[static_cast<std::size_t>(i)]);
    const cv::Point2d& q = corner.point;
    const cv::Matx<double, 2, 8> by_unknowns(1, q.x, q.y, 0, 0, 0, q.x * q.x, q.x * q.y,  //
                                             0, 0, 0, 1, q.x, q.y, q.x * q.y, q.y * q.y);
    const cv::Matx<double, 2, 8> rows = -1.0 * corner.jacobian.inv() * by_unknowns;
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 8; ++column)
        moved(2 * i + row, column) = rows(row, column);
  }
  return moved;
}

}  // namespace robot_vision
