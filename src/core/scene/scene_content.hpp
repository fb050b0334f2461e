#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/scene/scene.hpp"
#include "scene_cameras.hpp"
#include "scene_canvas.hpp"
#include "scene_noise.hpp"

namespace robot_vision
{

/// What a scene shows, and the cameras that see it.
struct Scene::Content
{
  /// Throws std::invalid_argument as validate() does.
  explicit Content(const SceneParams& params);
  virtual ~Content() = default;

  /// The truth at a time of the motion (s), without the number of the frame.
  virtual SceneTruth truth(double seconds) const = 0;

  /// Draws everything on the canvas of a camera that stands beside the color camera, `offset` (m) from it in its
  /// optical frame, and looks in the same direction. Writes every pixel.
  virtual void draw(double seconds, const cv::Vec3d& offset, scene::Canvas& canvas) const = 0;

  double rate;  // Hz, in the beginning
  scene::SceneCameras cameras;
  scene::PixelNoise noise, right_noise;
};

}  // namespace robot_vision
