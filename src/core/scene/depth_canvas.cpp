#include <algorithm>
#include <cmath>
#include <limits>

#include "scene_canvas.hpp"

namespace robot_vision::scene
{

namespace
{

/// Puts 1/z of a rectangle with these half sizes (m) into a run of pixels whose rays meet it before what is there.
/// `plane` is that of rayToPlane().
void meet(const cv::Matx33d& plane, const cv::Size2d& half, const float* xs, const float* ys, int count, float* inverse)
{
  for (int i = 0; i < count; ++i)
  {
    const double x = xs[i], y = ys[i];
    const double a = plane(0, 0) * x + plane(0, 1) * y + plane(0, 2);
    const double b = plane(1, 0) * x + plane(1, 1) * y + plane(1, 2);
    const double inverse_z = plane(2, 0) * x + plane(2, 1) * y + plane(2, 2);
    // (a, b) is the point times 1/z, and negative distances are inside. No distance is behind the camera.
    const double outside = std::max(std::abs(a) - half.width * inverse_z, std::abs(b) - half.height * inverse_z);
    const float nearest = std::max(inverse[i], static_cast<float>(inverse_z));
    inverse[i] = outside <= 0.0 ? nearest : inverse[i];
  }
}

}  // namespace

void DepthCanvas::background(const cv::Scalar& /*bgr*/)
{
  depth_.setTo(0.0);
}

void DepthCanvas::ground(const cv::Scalar& /*bgr*/, const cv::Scalar& /*sky*/, const cv::Affine3d& pose)
{
  const double endless = std::numeric_limits<double>::infinity();
  depth_.setTo(0.0);
  const cv::Point whole_row(0, depth_.cols);
  plane(pose, {endless, endless}, {0, std::vector<cv::Point>(static_cast<std::size_t>(depth_.rows), whole_row)});
}

void DepthCanvas::board(const Texture& /*texture*/, const cv::Affine3d& pose, const cv::Size2d& size)
{
  if (facesCamera(pose)) plane(pose, size, boardSpans(pose, size, lens_));
}

void DepthCanvas::plane(const cv::Affine3d& pose, const cv::Size2d& size, const RowSpans& rows)
{
  const cv::Matx33d ray_to_plane = rayToPlane(pose);
  const cv::Size2d half(size.width / 2.0, size.height / 2.0);
  for (std::size_t i = 0; i < rows.spans.size(); ++i)
  {
    const int row = rows.top + static_cast<int>(i), begin = rows.spans[i].x, count = rows.spans[i].y - begin;
    meet(ray_to_plane, half, lens_.rays.x.ptr<float>(row) + begin, lens_.rays.y.ptr<float>(row) + begin, count,
         depth_.ptr<float>(row) + begin);
  }
}

void DepthCanvas::ball(const cv::Point3d& center, double radius, const cv::Vec3d& /*to_light*/)
{
  const int points = 64;
  const RowSpans rows = rowSpans(ballOutline(lens_.camera, center, radius, points), lens_.camera);
  const double to_outline = center.dot(center) - radius * radius;  // squared distance, m^2
  for (std::size_t i = 0; i < rows.spans.size(); ++i)
  {
    const int row = rows.top + static_cast<int>(i);
    float* inverse = depth_.ptr<float>(row);
    for (int column = rows.spans[i].x; column < rows.spans[i].y; ++column)
    {
      const cv::Point3d ray(lens_.rays.x.at<float>(row, column), lens_.rays.y.at<float>(row, column), 1.0);
      // A point z * ray of the ball has (z * ray - center)^2 = radius^2, a quadratic equation for 1/z.
      const double along = center.dot(ray), root = along * along - ray.dot(ray) * to_outline;
      if (root < 0.0) continue;
      inverse[column] = std::max(inverse[column], static_cast<float>((along + std::sqrt(root)) / to_outline));
    }
  }
}

void DepthCanvas::finish()
{
  for (int row = 0; row < depth_.rows; ++row)
  {
    float* depth = depth_.ptr<float>(row);
    for (int column = 0; column < depth_.cols; ++column)
      depth[column] = depth[column] > 0.0F ? 1.0F / depth[column] : std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace robot_vision::scene
