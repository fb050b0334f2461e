#pragma once

#include <memory>

#include "robot_vision/camera/open_source.hpp"

namespace robot_vision
{

/// Opens the synthetic scene that `params` name. Each frame has its ground truth. Throws SourceError for a poster or a
/// mesh that cannot be read.
std::unique_ptr<FrameSource> openScene(const CaptureParams& params);

}  // namespace robot_vision
