#include "inverse_depth.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "depth_kernels.hpp"

namespace robot_vision
{

void invertDepth(const cv::Mat& depth, const std::string& encoding, const RayTable& rays, cv::Mat& inverse)
{
  inverse.create(depth.size(), CV_32FC1);
  std::vector<float> metres(static_cast<std::size_t>(depth.cols));
  for (int y = 0; y < depth.rows; ++y)
  {
    if (encoding != "32FC1") kernels<DepthKernels>().metres(depth.ptr<std::uint16_t>(y), depth.cols, metres.data());
    const float* const depths = encoding == "32FC1" ? depth.ptr<float>(y) : metres.data();
    kernels<DepthKernels>().inverses(depths, rays.x.ptr<float>(y), depth.cols, inverse.ptr<float>(y));
  }
}

}  // namespace robot_vision
