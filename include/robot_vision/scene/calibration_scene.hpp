#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"
#include "scene.hpp"

namespace robot_vision
{

/// Somebody shows a checkerboard to the camera of the synthetic Scene, as one does to calibrate it: each half second in
/// another pose, all over the picture, near and far, tilted to all sides and always seen whole. It is the checkerboard
/// of the room: kSceneCheckerSquare, 8 x 6 inner corners. Const and without scratch memory: threads may share one.
class CalibrationScene
{
public:
  /// Of the parameters `still` has no meaning here. Throws std::invalid_argument as validate(SceneParams) does.
  explicit CalibrationScene(const SceneParams& params);
  ~CalibrationScene();
  CalibrationScene(CalibrationScene&&) noexcept;
  CalibrationScene& operator=(CalibrationScene&&) noexcept;

  const CameraModel& camera() const;

  /// One object, the checkerboard, seen from the camera of the room's frame 0.
  SceneTruth truth(std::int64_t frame) const;

  /// Draws a frame as CV_8UC3 BGR. Memory of the right size and type is reused, foreign and padded rows included.
  void render(std::int64_t frame, cv::Mat& bgr) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
