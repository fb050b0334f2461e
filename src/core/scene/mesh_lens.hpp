#pragma once

#include <memory>
#include <mutex>

#include "robot_vision/meshes/mesh_renderer.hpp"

namespace robot_vision::scene
{

/// The cameras by which meshes are drawn. Each is made when somebody first asks for it, because most never do.
/// Thread-safe.
class MeshLens
{
public:
  explicit MeshLens(const CameraModel& camera) : camera_(camera) {}

  /// The camera itself.
  const MeshCamera& pixels() const;

  /// The same with twice as many pixels in both directions: four in each of the camera's.
  const MeshCamera& quarters() const;

private:
  CameraModel camera_;
  mutable std::once_flag pixels_once_, quarters_once_;
  mutable std::unique_ptr<const MeshCamera> pixels_, quarters_;
};

}  // namespace robot_vision::scene
