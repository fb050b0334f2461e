#pragma once

#include <memory>
#include <mutex>
#include <opencv2/core.hpp>

#include "robot_vision/scene/scene.hpp"
#include "scene_view.hpp"

namespace robot_vision::scene
{

/// Where the camera of a view is in the color camera's optical frame, m. It looks in the same direction.
cv::Vec3d viewOffset(SceneView view);

/// The depth camera beside a color camera whose images are so wide (px).
CameraModel depthCamera(int color_width);

/// The cameras of a scene.
class SceneCameras
{
public:
  /// `width` and `height` are those of the color images, px.
  SceneCameras(int width, int height);

  const CameraModel& model(SceneView view) const;

  /// The same camera with the rays of its pixels. Those of the depth camera are computed when somebody first asks for
  /// them, because most never do. Thread-safe.
  const Lens& lens(SceneView view) const;

  const Lens& color() const { return color_; }

private:
  Lens color_;  // also of the right camera
  CameraModel depth_model_;
  mutable std::once_flag depth_once_;
  mutable std::unique_ptr<const Lens> depth_;
};

}  // namespace robot_vision::scene
