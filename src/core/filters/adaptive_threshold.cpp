#include "adaptive_threshold.hpp"

#include "box_filter.hpp"
#include "threshold_kernels.hpp"

namespace robot_vision
{

void adaptiveMeanThreshold(const cv::Mat& gray, int size, double offset, bool inverse, cv::Mat& out)
{
  boxFilter(gray, size, cv::BORDER_REPLICATE, out);
  const int difference = -(inverse ? cvFloor(offset) : cvCeil(offset));
  for (int y = 0; y < gray.rows; ++y)
    kernels<ThresholdKernels>().compare_with_mean(gray.ptr(y), difference, inverse ? 255 : 0, gray.cols, out.ptr(y));
}

}  // namespace robot_vision
