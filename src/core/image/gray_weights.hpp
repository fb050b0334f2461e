#pragma once

#include "gray_kernels.hpp"

namespace robot_vision
{

/// Those by which cv::cvtColor makes colours of 8 bits gray, for BGR, which differ between versions of OpenCV. Null: it
/// does not do so by any that are known here.
const GrayWeights* grayWeightsOfBgr();

}  // namespace robot_vision
