#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/stereo/stereo_camera.hpp"

namespace robot_vision
{

struct StereoDepthParams
{
  std::string depth_encoding = "32FC1";

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("depth_encoding", &StereoDepthParams::depth_encoding, OneOf{"32FC1 or 16UC1"}, "",
          "of the depth: m, NaN where there is none, or mm, 0 there");
  }
};

// The functions throw std::invalid_argument if an image is of another type than they say, or two are not of one size.
// `out` is reused if it fits.

/// Writes the distances along the optical axis of a rectified left camera, CV_32FC1, m: fx * baseline / (disparity -
/// offset), and NaN where the disparity (CV_32FC1, px) is NaN or not beyond that of what is infinitely far away.
void depthFromDisparity(const cv::Mat& disparity, const StereoGeometry& geometry, cv::Mat& out);

/// Writes such a depth in an encoding of StereoDepthParams: CV_32FC1 as it is, or CV_16UC1, mm, with 0 for NaN and for
/// what is beyond 65.535 m.
void encodeDepth(const cv::Mat& depth, const std::string& encoding, cv::Mat& out);

/// Writes disparities (CV_32FC1, px) as colors (CV_8UC3, BGR): from blue for `lowest` or less to red for `highest` or
/// more (cv::COLORMAP_TURBO), black for NaN. Throws also if `highest` is not above `lowest`.
void disparityToColors(const cv::Mat& disparity, double lowest, double highest, cv::Mat& out);

}  // namespace robot_vision
