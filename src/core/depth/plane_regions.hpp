#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "plane_sums.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// The standard deviation of inverse depths, 1/m, at one of them: `noise` + `min_noise` w^2.
struct InverseNoise
{
  double noise;
  double min_noise;

  double at(double w) const { return noise + min_noise * w * w; }
};

/// Blocks of an image that are on one plane.
struct PlaneRegion
{
  std::vector<int> blocks;  // row by row counted
  PlaneSums sums;           // of all of their pixels
  InversePlane plane;       // by these
};

/// An image divided into square blocks; those at its end may be smaller.
class PlaneBlocks
{
public:
  static constexpr int kSide = 8;  // px

  /// Sums up an image of inverse depths (CV_32FC1, 0: none).
  void sumUp(const cv::Mat& inverse, const RayTable& rays);

  /// Finds regions with at least so many pixels, the largest first.
  std::vector<PlaneRegion> grow(const InverseNoise& noise, double min_pixels);

  /// Adds the blocks of a region, and those that touch them at a side or a corner, as rectangles of pixels: blocks
  /// beside each other are one.
  void addParts(const PlaneRegion& region, std::vector<cv::Rect>& parts) const;

private:
  cv::Rect rect(int block) const;  // px
  bool isPlanar(const PlaneSums& sums, const InversePlane& plane, const InverseNoise& noise, double limit) const;
  PlaneRegion growFrom(int seed, const InverseNoise& noise);

  cv::Size image_;               // px
  cv::Size size_;                // blocks
  std::vector<PlaneSums> sums_;  // of each block
  std::vector<std::uint8_t> is_free_;
};

}  // namespace robot_vision
