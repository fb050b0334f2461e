#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/recognition/symmetry.hpp"

namespace robot_vision
{

/// A line that an object may be turned about by any angle, and nobody sees it.
struct FreeAxis
{
  cv::Vec3d point;      // m, anywhere on the line
  cv::Vec3d direction;  // of length 1
};

/// Some points of the surface that an object shows to one side.
struct SurfaceView
{
  cv::Vec3f direction;             // to the viewer, of length 1, in the mesh's frame
  std::vector<cv::Vec3f> points;   // m, from the center of the mesh
  std::vector<cv::Vec3f> normals;  // of length 1
};

/// What refining and verifying poses needs to know of an object. Threads may share one, because it never changes.
class ObjectShape
{
public:
  /// `symmetries` are those that are known; axes that others are about are found in each pose. Draws the mesh some
  /// hundred times. Throws std::invalid_argument as validate(Mesh) and SymmetryGroup do, and for a mesh without any
  /// extent.
  explicit ObjectShape(const Mesh& mesh, const std::vector<Symmetry>& symmetries = {});
  ~ObjectShape();

  const MeshRenderer& renderer() const;
  const MeshExtent& extent() const { return renderer().extent(); }

  /// Those that are known.
  const SymmetryGroup& symmetries() const;

  /// The axes of those that are known, in the mesh's frame: none, one, or three of a ball.
  const std::vector<FreeAxis>& freeAxes() const;

  /// Whether its colors tell it from others: it has a texture, colors of its vertices, or a color that is no gray.
  bool hasColors() const;

  /// The rotations about the center of the mesh, besides none, that change its colors alone: a box with a print looks
  /// the same from behind, but for the print. Found about the axes of the mesh's frame. Empty without colors.
  const std::vector<cv::Matx33d>& lookAlikes() const;

  /// What it shows in a direction that is nearly this one, in the mesh's frame; of any length.
  const SurfaceView& viewFrom(const cv::Vec3d& direction) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
