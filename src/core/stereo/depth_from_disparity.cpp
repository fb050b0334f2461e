#include "robot_vision/stereo/depth_from_disparity.hpp"

#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kMmPerM = 1000.0F;
constexpr float kMaxMm = 65535.0F;
const std::string kFloats = "32FC1";

/// Calls work(value, out) for each pixel of an image of floats and of `out`, which has one pixel for each of them.
template <class Out, class Work>
void forPixels(const cv::Mat& image, cv::Mat& out, const Work& work)
{
  for (int y = 0; y < image.rows; ++y)
  {
    const auto* from = image.ptr<float>(y);
    auto* to = out.ptr<Out>(y);
    for (int x = 0; x < image.cols; ++x)
      work(from[x], to[x]);
  }
}

}  // namespace

void depthFromDisparity(const cv::Mat& disparity, const StereoGeometry& geometry, cv::Mat& out)
{
  checkPixels(disparity, kFloats, CV_32FC1);
  out.create(disparity.size(), CV_32FC1);
  const auto scale = static_cast<float>(geometry.fx * geometry.baseline), offset = static_cast<float>(geometry.offset);
  forPixels<float>(disparity, out,
                   [=](float found, float& z)
                   {
                     const float beyond = found - offset;
                     z = beyond > 0.0F ? scale / beyond : kNan;  // NaN is not above 0, either
                   });
}

void encodeDepth(const cv::Mat& depth, const std::string& encoding, cv::Mat& out)
{
  checkPixels(depth, kFloats, CV_32FC1);
  checkField("depth_encoding", encoding, OneOf{"32FC1 or 16UC1"});
  if (encoding == kFloats)
  {
    depth.copyTo(out);
    return;
  }
  out.create(depth.size(), CV_16UC1);
  forPixels<std::uint16_t>(depth, out,
                           [](float z, std::uint16_t& mm)
                           {
                             const float rounded = kMmPerM * z + 0.5F;
                             const bool fits = rounded >= 1.0F && rounded < kMaxMm + 1.0F;
                             mm = fits ? static_cast<std::uint16_t>(rounded) : std::uint16_t{0};
                           });
}

void pointsFromDepth(const cv::Mat& depth, const StereoGeometry& geometry, cv::Mat& out)
{
  checkPixels(depth, kFloats, CV_32FC1);
  require(geometry.fx > 0.0 && geometry.fy > 0.0, "the focal length", geometry.fx, "above 0");
  out.create(depth.size(), CV_32FC3);
  for (int y = 0; y < depth.rows; ++y)
  {
    const auto* row = depth.ptr<float>(y);
    auto* points = out.ptr<cv::Vec3f>(y);
    const auto down = static_cast<float>((y - geometry.cy) / geometry.fy);
    for (int x = 0; x < depth.cols; ++x)
    {
      const auto aside = static_cast<float>((x - geometry.cx) / geometry.fx);
      points[x] = cv::Vec3f(aside * row[x], down * row[x], row[x]);
    }
  }
}

void disparityToColors(const cv::Mat& disparity, double lowest, double highest, cv::Mat& out)
{
  checkPixels(disparity, kFloats, CV_32FC1);
  require(highest > lowest, "the highest disparity", highest, "above the lowest, " + toText(lowest));
  const cv::Mat found = disparity == disparity;  // all but NaN
  cv::Mat known = disparity.clone();
  cv::patchNaNs(known, lowest);
  cv::Mat levels, colors;
  const double scale = 255.0 / (highest - lowest);
  known.convertTo(levels, CV_8U, scale, -scale * lowest);
  cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
  out.create(disparity.size(), CV_8UC3);
  out.setTo(0);
  colors.copyTo(out, found);
}

}  // namespace robot_vision
