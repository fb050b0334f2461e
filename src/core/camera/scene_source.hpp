#pragma once

#include <memory>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// A synthetic scene, the one that `params` name, as a camera: frame after frame, each with its ground truth. Throws
/// SourceError for a poster that cannot be read.
std::unique_ptr<FrameSource> openScene(const CaptureParams& params);

}  // namespace robot_vision
