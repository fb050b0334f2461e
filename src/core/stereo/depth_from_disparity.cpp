#include "robot_vision/stereo/depth_from_disparity.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const std::string kFloats = "32FC1";

}  // namespace

void depthFromDisparity(const cv::Mat& disparity, const StereoGeometry& geometry, cv::Mat& out)
{
  checkPixels(disparity, kFloats, CV_32FC1);
  out.create(disparity.size(), CV_32FC1);
  const auto scale = static_cast<float>(geometry.fx * geometry.baseline), offset = static_cast<float>(geometry.offset);
  for (int y = 0; y < disparity.rows; ++y)
  {
    const auto* from = disparity.ptr<float>(y);
    std::transform(from, from + disparity.cols, out.ptr<float>(y),
                   [=](float found)
                   {
                     const float beyond = found - offset;
                     return beyond > 0.0F ? scale / beyond : kNan;  // NaN is not above 0, either
                   });
  }
}

void encodeDepth(const cv::Mat& depth, const std::string& encoding, cv::Mat& out)
{
  checkPixels(depth, kFloats, CV_32FC1);
  checkField("depth_encoding", encoding, OneOf{"32FC1 or 16UC1"});
  if (encoding == kFloats)
    depth.copyTo(out);
  else
    toMillimetres(depth, kFloats, out);
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
