#pragma once

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

/// What a ray meets first of a mesh.
struct RayHit
{
  double z = std::numeric_limits<double>::infinity();  // m, in the optical frame
  int triangle = -1;
  double edge = std::numeric_limits<double>::infinity();  // how far the hit is from the edge of its triangle, or the
                                                          // ray from a triangle that it just misses, in shares of it
};

/// Tries every triangle, by Moller and Trumbore's method, so it is slow and simple. The ray is (x, y, 1) in the optical
/// frame, and `pose` that of the mesh.
inline RayHit castRay(const robot_vision::Mesh& mesh, const cv::Affine3d& pose, const cv::Vec3d& ray)
{
  RayHit hit;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
  {
    const auto corner = [&](int k)
    { return cv::Vec3d(pose * cv::Vec3d(mesh.vertices[static_cast<std::size_t>(mesh.triangles[i][k])])); };
    const cv::Vec3d a = corner(0), ab = corner(1) - a, ac = corner(2) - a, p = ray.cross(ac);
    const double det = ab.dot(p);
    if (det == 0.0) continue;
    const double u = -a.dot(p) / det;
    const cv::Vec3d q = (-a).cross(ab);
    const double v = ray.dot(q) / det, z = ac.dot(q) / det;
    const double inside = std::min({u, v, 1.0 - u - v});
    if (z > 0.0) hit.edge = std::min(hit.edge, std::abs(inside));
    if (inside < 0.0 || z <= 0.0 || z >= hit.z) continue;
    hit.z = z;
    hit.triangle = static_cast<int>(i);
  }
  return hit;
}
