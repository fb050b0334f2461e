#include "robot_vision/depth/depth_points.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "depth_kernels.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

DepthPoints::DepthPoints(const CameraModel& camera) : camera_((validate(camera), camera)), rays_(rayTable(camera))
{
}

/// Calls write(y, depths, rays, points) for each row.
template <class Write>
void DepthPoints::forRows(const cv::Mat& depth, const std::string& encoding, int type, cv::Mat& points,
                          const Write& write) const
{
  checkDepth(depth, encoding, {camera_.width, camera_.height});
  points.create(depth.size(), type);
  std::vector<float> metres(static_cast<std::size_t>(depth.cols));
  for (int y = 0; y < depth.rows; ++y)
  {
    if (depth.type() == CV_16UC1)
      kernels<DepthKernels>().metres(depth.ptr<std::uint16_t>(y), depth.cols, metres.data());
    const float* const depths = depth.type() == CV_16UC1 ? metres.data() : depth.ptr<float>(y);
    write(y, depths, RayRow{rays_.x.ptr<float>(y), rays_.y.ptr<float>(y)}, points.ptr<float>(y));
  }
}

void DepthPoints::points(const cv::Mat& depth, const std::string& encoding, cv::Mat& xyz) const
{
  forRows(depth, encoding, CV_32FC3, xyz,
          [&](int, const float* depths, const RayRow& rays, float* points)
          { kernels<DepthKernels>().points(depths, rays, camera_.width, points); });
}

void DepthPoints::cloud(const cv::Mat& depth, const std::string& encoding, cv::Mat& xyz1) const
{
  forRows(depth, encoding, CV_32FC4, xyz1,
          [&](int, const float* depths, const RayRow& rays, float* points)
          { kernels<DepthKernels>().padded_points(depths, rays, camera_.width, points); });
}

void DepthPoints::cloud(const cv::Mat& depth, const std::string& encoding, const cv::Mat& bgr, cv::Mat& xyzrgb) const
{
  checkPixels(bgr, "bgr8");
  require(bgr.size() == depth.size(), "the size of the color image", toText(bgr.size()),
          toText(depth.size()) + " as of the depth image");
  forRows(depth, encoding, CV_32FC4, xyzrgb,
          [&](int y, const float* depths, const RayRow& rays, float* points)
          { kernels<DepthKernels>().colored_points(depths, rays, bgr.ptr(y), camera_.width, points); });
}

}  // namespace robot_vision
