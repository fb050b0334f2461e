// The samples that a lathe makes, at least mostly.

#include <cmath>

#include "mesh_builder.hpp"
#include "sample_meshes.hpp"

namespace robot_vision::samples
{
namespace
{

constexpr int kSegments = 48;

/// Points of an ellipse around (radius, height), from an angle to another (deg, 0 is outwards, 90 up).
std::vector<cv::Vec2d> arc(const cv::Vec2d& center, const cv::Vec2d& half_sizes, double from, double to, int pieces)
{
  std::vector<cv::Vec2d> points;
  for (int i = 0; i <= pieces; ++i)
  {
    const double angle = (from + (to - from) * i / pieces) * CV_PI / 180.0;
    points.emplace_back(center[0] + half_sizes[0] * std::cos(angle), center[1] + half_sizes[1] * std::sin(angle));
  }
  points.front()[0] = std::abs(points.front()[0]) < 1e-9 ? 0.0 : points.front()[0];
  points.back()[0] = std::abs(points.back()[0]) < 1e-9 ? 0.0 : points.back()[0];
  return points;
}

/// Points on a straight line.
std::vector<cv::Vec2d> straight(const cv::Vec2d& from, const cv::Vec2d& to, int pieces)
{
  std::vector<cv::Vec2d> points;
  for (int i = 0; i <= pieces; ++i)
    points.push_back(from + (to - from) * (static_cast<double>(i) / pieces));
  return points;
}

std::vector<cv::Vec2d> chain(std::vector<cv::Vec2d> first, const std::vector<cv::Vec2d>& second)
{
  first.insert(first.end(), second.begin() + 1, second.end());
  return first;
}

}  // namespace

Mesh bottle()
{
  const cv::Vec3b green(70, 120, 40), white(225, 230, 230), blue(170, 70, 30);
  const double r = 0.036, neck = 0.0135;
  return lathe({{straight({0, 0}, {r - 0.004, 0}, 4), green},
                {chain(arc({r - 0.004, 0.004}, {0.004, 0.004}, -90, 0, 4), straight({r, 0.004}, {r, 0.045}, 6)), green},
                {straight({r, 0.045}, {r, 0.105}, 8), white},
                {chain(straight({r, 0.105}, {r, 0.13}, 4), chain(arc({0.011, 0.13}, {r - 0.011, 0.045}, 0, 82, 12),
                                                                 {{0.0145, 0.1746}, {neck, 0.182}, {neck, 0.2}})),
                 green},
                {straight({neck, 0.2}, {0.0155, 0.2}, 1), blue},
                {straight({0.0155, 0.2}, {0.0155, 0.217}, 3), blue},
                {straight({0.0155, 0.217}, {0, 0.217}, 3), blue}},
               kSegments);
}

Mesh can()
{
  const cv::Vec3b red(40, 30, 190), silver(190, 190, 188), white(235, 235, 235);
  const double r = 0.033, rim = 0.027;
  return lathe({{arc({0, 0.0}, {0.022, 0.008}, 90, 0, 6), silver},
                {straight({0.022, 0}, {0.024, 0}, 1), silver},
                {straight({0.024, 0}, {r, 0.009}, 4), silver},
                {straight({r, 0.009}, {r, 0.035}, 5), red},
                {straight({r, 0.035}, {r, 0.052}, 4), white},
                {straight({r, 0.052}, {r, 0.103}, 8), red},
                {straight({r, 0.103}, {rim, 0.115}, 4), silver},
                {straight({rim, 0.115}, {rim - 0.002, 0.115}, 1), silver},
                {straight({rim - 0.002, 0.115}, {rim - 0.003, 0.11}, 2), silver},
                {straight({rim - 0.003, 0.11}, {0, 0.11}, 5), silver}},
               kSegments);
}

Mesh mug()
{
  const cv::Vec3b outside(185, 130, 60), inside(225, 228, 228);
  const double r = 0.04, wall = 0.0035, height = 0.095;
  const double middle = r - wall / 2.0;
  Mesh mesh = lathe(
      {{straight({0, 0}, {r - 0.005, 0}, 4), outside},
       {chain(arc({r - 0.005, 0.005}, {0.005, 0.005}, -90, 0, 4), straight({r, 0.005}, {r, height}, 10)), outside},
       {arc({middle, height}, {wall / 2.0, wall / 2.0}, 0, 180, 6), inside},
       {straight({r - wall, height}, {r - wall, 0.006}, 10), inside},
       {straight({r - wall, 0.006}, {0, 0.006}, 4), inside}},
      kSegments);
  std::vector<cv::Vec3d> path;
  const int pieces = 20;
  for (int i = 0; i <= pieces; ++i)
  {
    const double angle = CV_PI * i / pieces;
    path.emplace_back(middle + 0.03 * std::sin(angle), 0.0, 0.05 + 0.027 * std::cos(angle));
  }
  add(mesh, tube(path, {0.004, 0.006}, 16, outside));
  return mesh;
}

Mesh nut()
{
  const cv::Vec3b steel(150, 145, 140);
  const double r = 0.03, hole = 0.016, height = 0.022, bevel = 0.003;
  Mesh mesh = lathe({{{{hole, 0}, {r - bevel, 0}}, steel},
                     {{{r - bevel, 0}, {r, bevel}}, steel},
                     {{{r, bevel}, {r, height - bevel}}, steel},
                     {{{r, height - bevel}, {r - bevel, height}}, steel},
                     {{{r - bevel, height}, {hole, height}}, steel},
                     {{{hole, height}, {hole, 0}}, steel}},
                    6);
  mesh.normals.clear();  // six flat sides
  return mesh;
}

}  // namespace robot_vision::samples
