#pragma once

#include "robot_vision/frame_source.hpp"
#include "robot_vision/scene.hpp"

namespace robot_vision
{

/// The synthetic scene as a camera: frame after frame, each with its ground truth.
class SceneSource : public FrameSource
{
public:
  explicit SceneSource(const CaptureParams& params);
  ReadResult read(Frame& frame) override;
  double rate() const override { return rate_; }
  std::string description() const override;
  const CameraModel* cameraModel() const override { return &scene_.camera(); }

private:
  double rate_;
  Scene scene_;
  std::int64_t next_ = 0;
};

}  // namespace robot_vision
