#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// The gray picture as toGray() makes it, and the same with its levels stretched as by cv::equalizeHist, to the bit:
/// gray levels are counted while they are in the processor's cache. By as many threads as cv::setNumThreads() says.
/// `plain` may share the input's pixels; `equalized` is reused if it fits, and must not share any with them.
void toEqualizedGray(const cv::Mat& image, const std::string& encoding, cv::Mat& plain, cv::Mat& equalized);

}  // namespace robot_vision
