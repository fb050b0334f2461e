#include "scene_cameras.hpp"

#include <algorithm>

namespace robot_vision::scene
{

cv::Vec3d viewOffset(SceneView view)
{
  if (view == SceneView::kRight) return {kSceneStereoBaseline, 0.0, 0.0};
  if (view == SceneView::kDepth) return {-kSceneDepthBaseline, 0.0, 0.0};
  return {0.0, 0.0, 0.0};
}

CameraModel depthCamera(int color_width)
{
  const int max_width = 640;  // px
  // A shorter one than that of the color camera: all that a color image of 4:3 shows beyond 0.6 m has a depth, too.
  const double focal_per_height = 1.05;
  const int unit = std::min(color_width, max_width) / 4;
  CameraModel camera;
  camera.width = 4 * unit;
  camera.height = 3 * unit;
  const double focal = focal_per_height * camera.height;
  const double middle_x = (camera.width - 1) / 2.0 - 0.006 * camera.width;
  const double middle_y = (camera.height - 1) / 2.0 + 0.004 * camera.height;
  camera.K = {focal, 0, middle_x, 0, focal, middle_y, 0, 0, 1};
  // With these the distorted radius grows steadily with the undistorted one, so every pixel has exactly one ray.
  camera.D = {-0.05, 0.03, 0.0003, 0.0005, 0.0};
  return camera;
}

SceneCameras::SceneCameras(int width, int height) : color_(sceneCamera(width, height)), depth_model_(depthCamera(width))
{
}

const CameraModel& SceneCameras::model(SceneView view) const
{
  return view == SceneView::kDepth ? depth_model_ : color_.camera;
}

const Lens& SceneCameras::lens(SceneView view) const
{
  if (view != SceneView::kDepth) return color_;
  std::call_once(depth_once_, [this] { depth_ = std::make_unique<const Lens>(depth_model_); });
  return *depth_;
}

}  // namespace robot_vision::scene
