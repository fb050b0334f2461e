#include "robot_vision/depth/depth_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "depth_kernels.hpp"
#include "depth_pixel.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kSamples = 64;  // columns, and rows, that oddDepth() looks at
constexpr double kMmPerMetre = 1000.0;
constexpr double kNearest = 0.05;          // m, median of what depth cameras see
constexpr double kFarthestMetres = 200.0;  // m, of 32FC1
constexpr double kFarthest = 30.0;         // m, of 16UC1, which ends at 65 m

/// The depths (m) of some pixels that have one.
std::vector<double> samplesOf(const cv::Mat& depth)
{
  const int dx = std::max(1, depth.cols / kSamples), dy = std::max(1, depth.rows / kSamples);
  std::vector<double> found;
  for (int y = dy / 2; y < depth.rows; y += dy)
    for (int x = dx / 2; x < depth.cols; x += dx)
    {
      const double z = depthAt(depth, x, y);
      if (!std::isnan(z)) found.push_back(z);
    }
  return found;
}

/// Whether any pixel has a depth.
bool hasDepth(const cv::Mat& depth)
{
  if (depth.type() == CV_16UC1) return cv::countNonZero(depth) > 0;
  for (int y = 0; y < depth.rows; ++y)
  {
    const auto* const row = depth.ptr<float>(y);
    if (std::any_of(row, row + depth.cols, [](float z) { return z > 0.0F && std::isfinite(z); })) return true;
  }
  return false;
}

}  // namespace

int depthType(const std::string& encoding)
{
  if (encoding == "32FC1") return CV_32FC1;
  require(encoding == "16UC1" || encoding == "mono16", "the encoding of a depth image", "'" + printable(encoding) + "'",
          "16UC1 (mm) or 32FC1 (m)");
  return CV_16UC1;
}

void checkDepth(const cv::Mat& depth, const std::string& encoding)
{
  checkPixels(depth, encoding, depthType(encoding));
}

void checkDepth(const cv::Mat& depth, const std::string& encoding, const cv::Size& size)
{
  checkDepth(depth, encoding);
  require(depth.size() == size, "the size of the depth image", toText(depth.size()),
          toText(size) + " as of its camera");
}

void toMetres(const cv::Mat& depth, const std::string& encoding, cv::Mat& metres)
{
  checkDepth(depth, encoding);
  const cv::Mat from = depth;  // keeps the pixels if `metres` is the same cv::Mat
  metres.create(from.size(), CV_32FC1);
  for (int y = 0; y < from.rows; ++y)
    if (from.type() == CV_16UC1)
      kernels<DepthKernels>().metres(from.ptr<std::uint16_t>(y), from.cols, metres.ptr<float>(y));
    else
      kernels<DepthKernels>().depths(from.ptr<float>(y), from.cols, metres.ptr<float>(y));
}

void toMillimetres(const cv::Mat& depth, const std::string& encoding, cv::Mat& millimetres)
{
  checkDepth(depth, encoding);
  const cv::Mat from = depth;
  if (from.type() == CV_16UC1)
  {
    from.copyTo(millimetres);
    return;
  }
  millimetres.create(from.size(), CV_16UC1);
  for (int y = 0; y < from.rows; ++y)
    kernels<DepthKernels>().millimetres(from.ptr<float>(y), from.cols, millimetres.ptr<std::uint16_t>(y));
}

std::string oddDepth(const cv::Mat& depth, const std::string& encoding)
{
  checkDepth(depth, encoding);
  std::vector<double> depths = samplesOf(depth);
  if (depths.empty()) return hasDepth(depth) ? "" : "none of the " + toText(depth.size()) + " pixels has a depth";
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  const bool in_mm = depth.type() == CV_16UC1;
  const double farthest = in_mm ? kFarthest : kFarthestMetres;
  if (*middle >= kNearest && *middle <= farthest) return "";
  const std::string unit = in_mm ? "mm" : "m";
  return "the median depth is " + toText(in_mm ? *middle * kMmPerMetre : *middle) + " " + unit + " by the encoding " +
         encoding + ", expected " + toText(kNearest) + " to " + toText(farthest) + " m: are the numbers in " + unit +
         "?";
}

}  // namespace robot_vision
