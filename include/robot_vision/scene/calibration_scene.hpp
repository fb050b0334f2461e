#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"
#include "scene.hpp"

namespace robot_vision
{

/// A checkerboard is shown to the camera of the synthetic Scene as one does to calibrate it: every half second in
/// another pose, all over the image, near and far, tilted to all sides and always completely in view. It is the room's
/// checkerboard: squares of kSceneCheckerSquare, 8 x 6 inner corners. All methods are const and use no scratch memory,
/// so threads may share one object.
class CalibrationScene
{
public:
  /// The parameter `still` has no effect here. Throws std::invalid_argument as validate(SceneParams) does.
  explicit CalibrationScene(const SceneParams& params);
  ~CalibrationScene();
  CalibrationScene(CalibrationScene&&) noexcept;
  CalibrationScene& operator=(CalibrationScene&&) noexcept;

  const CameraModel& camera() const;

  /// The only object is the checkerboard. The camera stays where the room's camera is in frame 0.
  SceneTruth truth(std::int64_t frame) const;

  /// Draws a frame as CV_8UC3 BGR. An image of the right size and type is written in place, also when its rows are
  /// padded or its memory belongs to somebody else.
  void render(std::int64_t frame, cv::Mat& bgr) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
