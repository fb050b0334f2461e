// Draws the ball and the line, the two shapes that are not textured rectangles. How much of a pixel they cover follows
// from its distance to their edge.

#include <algorithm>
#include <cmath>

#include "robot_vision/scene/scene.hpp"
#include "scene_painter.hpp"

namespace robot_vision::scene
{

namespace
{

const cv::Vec3f kBallColor(236.0F, 118.0F, 28.0F);  // blue: hue 107 of OpenCV's 180
const uchar kLineColor[3] = {38, 34, 34};

// The covered part of a pixel, 0 to 1. `inside` is a signed distance to the edge in any unit, positive inside the
// shape; `per_pixel` is its change from one pixel to the next.
float coverage(float inside, float per_pixel)
{
  return std::clamp(0.5F + inside / per_pixel, 0.0F, 1.0F);
}

int toAlpha(float part)
{
  return static_cast<int>(part * 255.0F + 0.5F);
}

// Computes the colour of the ball where a ray of unit length meets it, or comes closest to it.
void shadeBall(const cv::Vec3f& ray, const cv::Vec3f& center, float radius, const cv::Vec3f& to_light, uchar* color)
{
  const float ambient = 0.40F, gloss = 0.55F;
  const float along = center.dot(ray);
  const float inside = along * along - center.dot(center) + radius * radius;
  const cv::Vec3f normal = (ray * (along - std::sqrt(std::max(inside, 0.0F))) - center) / radius;
  const float facing = normal.dot(to_light);
  const float light = ambient + (1.0F - ambient) * std::max(facing, 0.0F);
  const float mirrored = std::max(2.0F * facing * normal.dot(-ray) + to_light.dot(ray), 0.0F);
  const float squared = mirrored * mirrored, eighth = squared * squared * squared * squared;
  const float shine = gloss * eighth * eighth;
  for (int i = 0; i < 3; ++i)
  {
    const float body = kBallColor[i] * light;
    color[i] = static_cast<uchar>(body + (245.0F - body) * shine + 0.5F);
  }
}

}  // namespace

void paintBall(const cv::Point3d& center, double radius, const cv::Vec3d& to_light, const Lens& lens, cv::Mat& bgr)
{
  const RowSpans rows = rowSpans(ballOutline(lens.camera, center, radius, 64), lens.camera);
  const cv::Vec3f c(static_cast<float>(center.x), static_cast<float>(center.y), static_cast<float>(center.z));
  const auto r = static_cast<float>(radius), focal = static_cast<float>(lens.camera.K(0, 0));
  const cv::Vec3f light = to_light;
  const float tangent = std::sqrt(c.dot(c) - r * r);  // distance from the camera to the points of the ball's outline
  for (std::size_t i = 0; i < rows.spans.size(); ++i)
  {
    const int row = rows.top + static_cast<int>(i);
    const float* xs = lens.rays.x.ptr<float>(row);
    const float* ys = lens.rays.y.ptr<float>(row);
    uchar* pixels = bgr.ptr(row);
    for (int column = rows.spans[i].x; column < rows.spans[i].y; ++column)
    {
      const cv::Vec3f ray(xs[column], ys[column], 1.0F);
      const float length = std::sqrt(ray.dot(ray));
      // This is positive for rays inside the cone that touches the ball.
      const float inside = c.dot(ray) - tangent * length;
      const float gradient = std::hypot(c[0] - tangent * ray[0] / length, c[1] - tangent * ray[1] / length) / focal;
      const int alpha = toAlpha(coverage(inside, gradient));
      if (alpha == 0) continue;
      uchar color[3];
      shadeBall(ray / length, c, r, light, color);
      blend(pixels + 3 * column, color, alpha);
    }
  }
}

void paintLine(const cv::Affine3d& world_in_camera, const Lens& lens, cv::Mat& bgr)
{
  const Polygon3 seen = clipToView(lineOutline(world_in_camera), lens);
  const RowSpans rows = rowSpans(project(seen, lens.camera, 2), lens.camera);
  const cv::Matx33f plane = rayToPlane(world_in_camera);  // its (a, b) are (forward, left) on the floor
  const auto focal = static_cast<float>(lens.camera.K(0, 0)), half = static_cast<float>(kSceneLineWidth / 2.0);
  const auto slope1 = static_cast<float>(kLineCurve[1]), slope2 = static_cast<float>(2.0 * kLineCurve[2]);
  for (std::size_t i = 0; i < rows.spans.size(); ++i)
  {
    const int row = rows.top + static_cast<int>(i);
    for (int column = rows.spans[i].x; column < rows.spans[i].y; ++column)
    {
      const cv::Vec3f p = plane * cv::Vec3f(lens.rays.x.at<float>(row, column), lens.rays.y.at<float>(row, column), 1);
      const float forward = p[0] / p[2], left = p[1] / p[2], step = 1.0F / (p[2] * focal);
      const float offset = left - static_cast<float>(lineCenter(forward)), slope = slope1 + slope2 * forward;
      // The changes of `forward` and of `offset` from pixel to pixel along both axes of the image.
      const cv::Vec2f d_forward((plane(0, 0) - forward * plane(2, 0)) * step,
                                (plane(0, 1) - forward * plane(2, 1)) * step);
      const cv::Vec2f d_offset = cv::Vec2f((plane(1, 0) - left * plane(2, 0)) * step,  //
                                           (plane(1, 1) - left * plane(2, 1)) * step) -
                                 slope * d_forward;
      const float across = std::sqrt(d_offset.dot(d_offset)), along = std::sqrt(d_forward.dot(d_forward));
      const float ends = std::min(static_cast<float>(kLineEnd) - forward, forward - static_cast<float>(kLineBegin));
      const float part = coverage(half - std::abs(offset), across) * coverage(ends, along);
      blend(bgr.ptr(row) + 3 * column, kLineColor, toAlpha(part));
    }
  }
}

}  // namespace robot_vision::scene
