#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// Converts to gray as toGray() does (`plain`), and equalizes the histogram bit for bit as cv::equalizeHist does
/// (`equalized`). Gray levels are counted while they are in the processor's cache, by as many threads as
/// cv::setNumThreads() allows. `plain` may share the input's pixels; `equalized` is reused if it fits, and must not
/// share any with them.
void toEqualizedGray(const cv::Mat& image, const std::string& encoding, cv::Mat& plain, cv::Mat& equalized);

}  // namespace robot_vision
