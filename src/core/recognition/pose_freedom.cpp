#include "pose_freedom.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace robot_vision
{
namespace
{

const double kAnyAngle = CV_PI / std::sqrt(3.0);  // rad, standard deviation
constexpr double kCertain = 0.003;                // rad: nothing that looks the same from all sides is so certain
constexpr double kTurn = 0.5;                     // rad, that are tried
constexpr int kMaxPixels = 2500;
constexpr double kMinAlike = 0.95;  // of the pixels
constexpr int kMaxColor = 40;       // difference of a channel

/// A line, and by how much (rad) it is not known how far the body is turned about it.
struct WeakAxis
{
  FreeAxis axis;
  double deviation;
};

WeakAxis weakest(const cv::Matx66d& covariance, const cv::Vec3d& center)
{
  cv::Vec3d values;
  cv::Matx33d vectors;
  cv::eigen(covariance.get_minor<3, 3>(3, 3), values, vectors);
  const cv::Vec3d direction(vectors(0, 0), vectors(0, 1), vectors(0, 2));
  // The shift of the origin that comes with the rotation says where the line is.
  const cv::Vec3d shift = covariance.get_minor<3, 3>(0, 3) * direction * (1.0 / std::max(values[0], 1e-12));
  return {{center + direction.cross(shift), direction}, std::sqrt(std::max(values[0], 0.0))};
}

cv::Affine3d turnedAbout(const FreeAxis& axis, double angle, const cv::Affine3d& pose)
{
  const cv::Affine3d turn(axis.direction * angle);
  return {turn.rotation() * pose.rotation(), axis.point + turn.rotation() * (pose.translation() - axis.point)};
}

}  // namespace

cv::Matx66d covarianceOf(const cv::Matx66d& information, double radius)
{
  // Rotations are measured by the way at that radius, so that all numbers are of a kind.
  cv::Matx66d scale = cv::Matx66d::eye();
  for (int i = 3; i < 6; ++i)
    scale(i, i) = 1.0 / radius;
  cv::Matx66d scaled = scale * information * scale;
  for (int i = 0; i < 6; ++i)
    scaled(i, i) += std::pow(i < 3 ? 2.0 * radius : kAnyAngle * radius, -2);
  return scale * scaled.inv(cv::DECOMP_CHOLESKY) * scale;
}

cv::Matx66d withFreeAxis(const cv::Matx66d& covariance, const FreeAxis& axis, const cv::Vec3d& center)
{
  const cv::Vec3d shift = axis.direction.cross(center - axis.point);
  cv::Vec6d motion;
  for (int i = 0; i < 3; ++i)
  {
    motion[i] = kAnyAngle * shift[i];
    motion[3 + i] = kAnyAngle * axis.direction[i];
  }
  return covariance + motion * motion.t();
}

std::optional<FreeAxis> FreedomCheck::find(const ObjectShape& shape, const cv::Affine3d& pose,
                                           const cv::Matx66d& covariance, const cv::Matx33d& K, const cv::Size& image,
                                           double deviation, bool texture)
{
  const cv::Vec3d center = pose * shape.extent().center;
  const WeakAxis weak = weakest(covariance, center);
  RenderParts parts;
  parts.bgr = texture;
  if (weak.deviation < kCertain || !drawRegion(shape, pose, K, image, kMaxPixels, parts, region_)) return std::nullopt;
  // Where the line is follows from small numbers. Most objects have it in their middle.
  for (const FreeAxis& axis : {weak.axis, FreeAxis{center, weak.axis.direction}})
    if (cv::norm(axis.point - center) < shape.extent().radius && isFree(shape, axis, deviation, parts)) return axis;
  return std::nullopt;
}

bool FreedomCheck::isFree(const ObjectShape& shape, const FreeAxis& axis, double deviation, const RenderParts& parts)
{
  for (const double angle : {kTurn, -kTurn})
  {
    shape.renderer().render(region_.K(), turnedAbout(axis, angle, region_.pose), {{0, 0}, region_.view.depth.size()},
                            turned_, parts);
    if (!looksAlike(region_.view, turned_, deviation)) return false;
  }
  return true;
}

bool FreedomCheck::looksAlike(const MeshView& a, const MeshView& b, double deviation) const
{
  int all = 0, alike = 0;
  for (int y = 0; y < a.depth.rows; ++y)
    for (int x = 0; x < a.depth.cols; ++x)
    {
      const float first = a.depth.at<float>(y, x), second = b.depth.at<float>(y, x);
      if (!(first > 0.0F) && !(second > 0.0F)) continue;
      ++all;
      bool is_alike = std::abs(static_cast<double>(first - second)) <= deviation;
      for (int i = 0; i < 3 && is_alike && !a.bgr.empty(); ++i)
        is_alike = std::abs(a.bgr.at<cv::Vec3b>(y, x)[i] - b.bgr.at<cv::Vec3b>(y, x)[i]) <= kMaxColor;
      alike += is_alike ? 1 : 0;
    }
  return alike >= kMinAlike * all;
}

}  // namespace robot_vision
