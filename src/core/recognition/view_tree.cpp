#include "robot_vision/recognition/view_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kEqual = 1e-6;        // rad, differences that are none
constexpr int kFinerSubdivisions = 2;  // of the directions that those of a symmetric object are chosen from
constexpr double kFullTurn = 2.0 * CV_PI;

double angleBetween(const cv::Vec3d& a, const cv::Vec3d& b)
{
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

/// Directions as the corners of triangles.
struct Sphere
{
  std::vector<cv::Vec3d> corners;
  std::vector<cv::Vec3i> triangles;
};

Sphere icosahedron()
{
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  Sphere sphere;
  for (const cv::Vec3d& corner : {cv::Vec3d(-1, g, 0), cv::Vec3d(1, g, 0), cv::Vec3d(-1, -g, 0), cv::Vec3d(1, -g, 0),
                                  cv::Vec3d(0, -1, g), cv::Vec3d(0, 1, g), cv::Vec3d(0, -1, -g), cv::Vec3d(0, 1, -g),
                                  cv::Vec3d(g, 0, -1), cv::Vec3d(g, 0, 1), cv::Vec3d(-g, 0, -1), cv::Vec3d(-g, 0, 1)})
    sphere.corners.push_back(cv::normalize(corner));
  sphere.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return sphere;
}

/// Divides each triangle in four; the corners that there were stay the first.
Sphere divided(const Sphere& sphere)
{
  Sphere finer{sphere.corners, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b)
  {
    const auto [at, is_new] = middles.insert({std::minmax(a, b), static_cast<int>(finer.corners.size())});
    if (is_new)
      finer.corners.push_back(
          cv::normalize(sphere.corners[static_cast<std::size_t>(a)] + sphere.corners[static_cast<std::size_t>(b)]));
    return at->second;
  };
  for (const cv::Vec3i& t : sphere.triangles)
  {
    const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
    for (const cv::Vec3i& part :
         {cv::Vec3i(t[0], a, c), cv::Vec3i(t[1], b, a), cv::Vec3i(t[2], c, b), cv::Vec3i(a, b, c)})
      finer.triangles.push_back(part);
  }
  return finer;
}

Sphere sphereOf(int subdivisions)
{
  Sphere sphere = icosahedron();
  for (int i = 0; i < subdivisions; ++i)
    sphere = divided(sphere);
  return sphere;
}

/// How far turns about the line of sight look different: less than a full turn along an axis of symmetry.
double spinOf(const cv::Vec3d& direction, const SymmetryGroup& symmetries)
{
  if (symmetries.isBall()) return 0.0;
  if (symmetries.axis() && angleBetween(direction, *symmetries.axis()) < kEqual) return 0.0;
  if (symmetries.axis() && angleBetween(direction, -*symmetries.axis()) < kEqual) return 0.0;
  int alike = 0;
  for (const cv::Matx33d& turn : symmetries.turns())
    alike += angleBetween(turn * direction, direction) < kEqual ? 1 : 0;
  return kFullTurn / alike;
}

/// The directions along the axes first, where turns about the line of sight are symmetries, then those to choose from.
std::vector<cv::Vec3d> candidates(int subdivisions, const SymmetryGroup& symmetries)
{
  std::vector<cv::Vec3d> directions;
  for (const Symmetry& symmetry : symmetries.symmetries())
    for (const double sign : {1.0, -1.0})
      directions.push_back(cv::normalize(symmetry.axis) * sign);
  const Sphere finer = sphereOf(subdivisions + kFinerSubdivisions);
  directions.insert(directions.end(), finer.corners.begin(), finer.corners.end());
  return directions;
}

/// Always the direction that is farthest from those chosen before, until none is farther than the finest level allows.
void chooseFarthest(int subdivisions, const SymmetryGroup& symmetries, ViewTree& tree)
{
  const std::vector<cv::Vec3d> all = candidates(subdivisions, symmetries);
  std::vector<double> distances(all.size(), CV_PI);
  std::size_t next = 0;
  for (int level = 0; level <= subdivisions; ++level)
  {
    const double gap = largestGap(level);
    for (; distances[next] > gap || tree.directions.empty();)
    {
      tree.directions.push_back({all[next], spinOf(all[next], symmetries), -1});
      double farthest = -1.0;
      const cv::Vec3d chosen = all[next];
      for (std::size_t i = 0; i < all.size(); ++i)
      {
        distances[i] = std::min(distances[i], symmetries.directionAngle(chosen, all[i]));
        if (distances[i] > farthest + kEqual) next = i;
        farthest = std::max(farthest, distances[i]);
      }
    }
    tree.levels.push_back(static_cast<int>(tree.directions.size()));
  }
}

void findParents(const SymmetryGroup& symmetries, ViewTree& tree)
{
  for (std::size_t level = 1; level < tree.levels.size(); ++level)
    for (int i = tree.levels[level - 1]; i < tree.levels[level]; ++i)
    {
      ViewDirection& child = tree.directions[static_cast<std::size_t>(i)];
      double nearest = 2.0 * CV_PI;
      for (int j = 0; j < tree.levels[level - 1]; ++j)
      {
        const cv::Vec3d& parent = tree.directions[static_cast<std::size_t>(j)].direction;
        const double angle = symmetries.directionAngle(parent, child.direction);
        if (angle < nearest - kEqual) child.parent = j;
        nearest = std::min(nearest, angle);
      }
    }
}

}  // namespace

double largestGap(int subdivisions)
{
  const Sphere sphere = sphereOf(subdivisions);
  double largest = 0.0;
  for (const cv::Vec3i& t : sphere.triangles)
  {
    const cv::Vec3d &a = sphere.corners[static_cast<std::size_t>(t[0])],
                    &b = sphere.corners[static_cast<std::size_t>(t[1])],
                    &c = sphere.corners[static_cast<std::size_t>(t[2])];
    const cv::Vec3d middle = cv::normalize((b - a).cross(c - a));
    largest = std::max(largest, std::acos(std::abs(middle.dot(a))));
  }
  return largest;
}

ViewTree viewTree(int subdivisions, const SymmetryGroup& symmetries)
{
  requireRange("subdivisions", subdivisions, 0, kMaxSubdivisions);
  ViewTree tree;
  if (symmetries.symmetries().empty())
  {
    for (const cv::Vec3d& direction : sphereOf(subdivisions).corners)
      tree.directions.push_back({direction, kFullTurn, -1});
    for (int level = 0; level <= subdivisions; ++level)
      tree.levels.push_back(2 + 10 * (1 << (2 * level)));
  }
  else
  {
    chooseFarthest(subdivisions, symmetries, tree);
  }
  findParents(symmetries, tree);
  return tree;
}

cv::Matx33d lookedAtFrom(const cv::Vec3d& direction)
{
  const cv::Vec3d up = std::abs(direction[2]) < 0.999 ? cv::Vec3d(0, 0, 1) : cv::Vec3d(0, 1, 0);
  const cv::Vec3d z = -direction, x = cv::normalize(z.cross(up)), y = z.cross(x);
  return {x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]};
}

}  // namespace robot_vision
