#include "mesh_lens.hpp"

namespace robot_vision::scene
{

const MeshCamera& MeshLens::pixels() const
{
  std::call_once(pixels_once_, [this] { pixels_ = std::make_unique<const MeshCamera>(camera_); });
  return *pixels_;
}

const MeshCamera& MeshLens::quarters() const
{
  std::call_once(quarters_once_,
                 [this]
                 {
                   CameraModel camera = camera_;
                   camera.width *= 2;
                   camera.height *= 2;
                   // Positions count from the middle of the first pixel, which is a quarter of a pixel farther out.
                   camera.K = cv::Matx33d(2, 0, 0.5, 0, 2, 0.5, 0, 0, 1) * camera.K;
                   quarters_ = std::make_unique<const MeshCamera>(camera);
                 });
  return *quarters_;
}

}  // namespace robot_vision::scene
