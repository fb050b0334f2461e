#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "depth_frames.hpp"
#include "robot_vision/depth/depth_normals.hpp"

namespace bench
{
namespace
{

constexpr int kRadius = 5;  // px

/// Normals by filters over the inverse of depth, whose slopes they measure in squares all of the same size: wrong
/// beside jumps.
class PlainNormals
{
public:
  void apply(const cv::Mat& depth, const robot_vision::CameraModel& camera, cv::Mat& normals)
  {
    const int side = 2 * kRadius + 1;
    cv::Mat slope(1, side, CV_32FC1), plain(1, side, CV_32FC1, cv::Scalar(1.0 / side));
    std::iota(slope.begin<float>(), slope.end<float>(), static_cast<float>(-kRadius));
    slope /= slope.dot(slope);
    cv::divide(1.0, depth, inverse_);
    cv::sepFilter2D(inverse_, across_, CV_32F, slope, plain);
    cv::sepFilter2D(inverse_, along_, CV_32F, plain, slope);
    cv::sepFilter2D(inverse_, mean_, CV_32F, plain, plain);
    normals.create(depth.size(), CV_32FC3);
    const auto fx = static_cast<float>(camera.K(0, 0)), fy = static_cast<float>(camera.K(1, 1));
    const auto cx = static_cast<float>(camera.K(0, 2)), cy = static_cast<float>(camera.K(1, 2));
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u)
      {
        const float a = across_.at<float>(v, u) * fx, b = along_.at<float>(v, u) * fy;
        const float c = mean_.at<float>(v, u) - across_.at<float>(v, u) * (static_cast<float>(u) - cx) -
                        along_.at<float>(v, u) * (static_cast<float>(v) - cy);
        const float scale = -1.0F / std::sqrt(a * a + b * b + c * c);
        normals.at<cv::Vec3f>(v, u) = {a * scale, b * scale, c * scale};
      }
  }

private:
  cv::Mat inverse_, across_, along_, mean_;
};

robot_vision::NormalParams paramsOf(const Setup& setup)
{
  robot_vision::NormalParams params;
  params.radius = kRadius;
  params.threads = setup.threads;
  return params;
}

struct NormalsState
{
  explicit NormalsState(const Setup& setup)
    : camera(depthCamera(setup.frames.front().size())),
      depth(enlarged(furnishedWorld().depth(depthCamera(kDepthSize)), setup.frames.front().size())),
      finder(camera, paramsOf(setup))
  {
  }

  void byOpenCv(std::size_t /*i*/) { plain.apply(depth, camera, theirs); }
  void byUs(std::size_t /*i*/) { finder.apply(depth, "32FC1", ours); }

  /// Of ours, which are there for most pixels, nearly all are alike: but those beside jumps.
  bool same() const
  {
    int known = 0, alike = 0;
    for (int y = 0; y < ours.rows; ++y)
      for (int x = 0; x < ours.cols; ++x)
      {
        const cv::Vec3f normal = ours.at<cv::Vec3f>(y, x);
        known += std::isnan(normal[0]) ? 0 : 1;
        alike += normal.dot(theirs.at<cv::Vec3f>(y, x)) > 0.999F ? 1 : 0;
      }
    return known > 0.9 * ours.size().area() && alike > 0.8 * known;
  }

  robot_vision::CameraModel camera;
  cv::Mat depth, theirs, ours;
  PlainNormals plain;
  robot_vision::DepthNormals finder;
};

}  // namespace

std::vector<Work> normalWorks()
{
  return {{"normals of depth", "sepFilter2D", 0.5, contestOf<NormalsState>()}};
}

}  // namespace bench
