// The samples that are made of simple bodies, blended with each other.

#include <algorithm>
#include <cmath>

#include "mesh_builder.hpp"
#include "sample_meshes.hpp"

namespace robot_vision::samples
{
namespace
{

double ball(const cv::Vec3d& p, const cv::Vec3d& center, double radius)
{
  return cv::norm(p - center) - radius;
}

/// About the distance to an ellipsoid: never more than that.
double ellipsoid(const cv::Vec3d& p, const cv::Vec3d& center, const cv::Vec3d& half_sizes)
{
  const cv::Vec3d at = p - center;
  const cv::Vec3d scaled(at[0] / half_sizes[0], at[1] / half_sizes[1], at[2] / half_sizes[2]);
  return (cv::norm(scaled) - 1.0) * std::min({half_sizes[0], half_sizes[1], half_sizes[2]});
}

/// A rod with round ends, whose radius changes from one end to the other.
double rod(const cv::Vec3d& p, const cv::Vec3d& a, const cv::Vec3d& b, double radius_a, double radius_b)
{
  const cv::Vec3d along = b - a;
  const double part = std::clamp((p - a).dot(along) / along.dot(along), 0.0, 1.0);
  return cv::norm(p - a - part * along) - radius_a - part * (radius_b - radius_a);
}

/// A box with round edges.
double roundBox(const cv::Vec3d& p, const cv::Vec3d& center, const cv::Vec3d& half_sizes, double edge)
{
  cv::Vec3d outside;
  double inside = -1.0;
  for (int i = 0; i < 3; ++i)
  {
    const double beyond = std::abs(p[i] - center[i]) - (half_sizes[i] - edge);
    outside[i] = std::max(beyond, 0.0);
    inside = i == 0 ? beyond : std::max(inside, beyond);
  }
  return cv::norm(outside) + std::min(inside, 0.0) - edge;
}

/// The union of two bodies with a fillet of this size.
double blended(double a, double b, double size)
{
  const double part = std::clamp(0.5 + 0.5 * (b - a) / size, 0.0, 1.0);
  return b + part * (a - b) - size * part * (1.0 - part);
}

/// A color where the distance is below 0, going over into another one within 3 mm: colors are only known at vertices.
cv::Vec3b mixed(const cv::Vec3b& inside, double distance, const cv::Vec3b& outside)
{
  const double part = std::clamp(0.5 + distance / 0.003, 0.0, 1.0);
  return cv::Vec3d(inside) * (1.0 - part) + cv::Vec3d(outside) * part;
}

/// What is above the plane z = 0.
double onGround(const cv::Vec3d& p, double body)
{
  return std::max(body, -p[2]);
}

double duckBeak(const cv::Vec3d& p)
{
  return ellipsoid(p, {0.062, 0, 0.082}, {0.016, 0.011, 0.005});
}

double duckBody(const cv::Vec3d& p)
{
  const cv::Vec3d mirrored(p[0], std::abs(p[1]), p[2]);
  double body = ellipsoid(p, {0, 0, 0.03}, {0.052, 0.036, 0.032});
  body = blended(body, rod(p, {-0.03, 0, 0.04}, {-0.063, 0, 0.062}, 0.016, 0.005), 0.02);  // the tail
  body = blended(body, ellipsoid(mirrored, {-0.012, 0.034, 0.038}, {0.028, 0.008, 0.016}), 0.006);
  return blended(body, ball(p, {0.032, 0, 0.083}, 0.026), 0.018);
}

double drillBody(const cv::Vec3d& p)
{
  double body = rod(p, {-0.045, 0, 0.155}, {0.045, 0, 0.155}, 0.026, 0.024);
  body = blended(body, rod(p, {-0.022, 0, 0.14}, {-0.034, 0, 0.045}, 0.017, 0.016), 0.012);
  return blended(body, roundBox(p, {-0.02, 0, 0.02}, {0.045, 0.028, 0.02}, 0.006), 0.01);
}

double drillChuck(const cv::Vec3d& p)
{
  return std::min(rod(p, {0.055, 0, 0.155}, {0.085, 0, 0.155}, 0.018, 0.011),
                  rod(p, {0.085, 0, 0.155}, {0.125, 0, 0.155}, 0.0045, 0.0045));
}

}  // namespace

Mesh duck()
{
  const auto distance = [](const cv::Vec3d& p) { return onGround(p, std::min(duckBody(p), duckBeak(p))); };
  const auto color = [](const cv::Vec3d& p)
  {
    const cv::Vec3d mirrored(p[0], std::abs(p[1]), p[2]);
    const cv::Vec3b body = mixed({20, 100, 235}, duckBeak(p) - 0.001, {45, 205, 240});
    return mixed({30, 25, 20}, ball(mirrored, {0.05, 0.016, 0.092}, 0.0055), body);  // with an eye
  };
  return solid(distance, color, {-0.075, -0.045, 0}, {0.08, 0.045, 0.11}, 0.0035);
}

Mesh drill()
{
  const auto distance = [](const cv::Vec3d& p) { return onGround(p, std::min(drillBody(p), drillChuck(p))); };
  const auto color = [](const cv::Vec3d& p)
  {
    const cv::Vec3b body = mixed({50, 45, 45}, p[2] - 0.046, {40, 150, 225});
    return mixed({75, 70, 70}, drillChuck(p) - 0.001, body);
  };
  return solid(distance, color, {-0.075, -0.03, 0}, {0.13, 0.03, 0.185}, 0.004);
}

}  // namespace robot_vision::samples
