#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Triangles of a surface, counter-clockwise for who sees the side of the larger values.
struct NetSurface
{
  std::vector<cv::Vec3f> vertices;  // in steps of the grid
  std::vector<cv::Vec3i> triangles;
};

/// The surface between the values below 0 and the others of a grid of `size` points, x fastest: one vertex in each cell
/// that it passes (Gibson: Constrained Elastic Surface Nets, 1998).
NetSurface surfaceNets(const std::vector<float>& values, const cv::Vec3i& size);

/// Keeps the pieces of a surface that hang together and have at least a share of the triangles of the largest one.
void keepLargePieces(double share, NetSurface& surface);

}  // namespace robot_vision
