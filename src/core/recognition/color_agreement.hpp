#pragma once

#include <opencv2/core.hpp>

#include "rendered_region.hpp"
#include "robot_vision/recognition/pose_verifier.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

/// Fills in how far the colors and the brightness of a region with colors are those of a frame, in blocks of pixels of
/// what is `explained` by the object.
void compareColors(const RenderedRegion& region, const RecognitionFrame& frame, const cv::Mat& explained,
                   double max_hue_error, PoseEvidence& evidence);

}  // namespace robot_vision
