#pragma once

#include "gray_kernels.hpp"

namespace robot_vision
{

/// The weights (in BGR order) by which cv::cvtColor converts 8-bit colours to gray in this version of OpenCV. Null if
/// none of the weights known here give its results.
const GrayWeights* grayWeightsOfBgr();

}  // namespace robot_vision
