#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct RegionParams
{
  double min_area = 200.0;
  int opening = 3;
  int closing = 3;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("min_area", &RegionParams::min_area, Range{0, 1e9}, "px^2", "smallest region; smaller ones are left out");
    visit("opening", &RegionParams::opening, OddRange{1, 31}, "px",
          "diameter of the ellipse of the opening, which removes specks; 1: none");
    visit("closing", &RegionParams::closing, OddRange{1, 31}, "px",
          "diameter of the ellipse of the closing, which fills holes; 1: none");
  }
};

/// A region of a mask: pixels that touch each other at a side or a corner. Pixel centres have integer coordinates.
struct Region
{
  cv::Rect box;                    // px
  cv::Point2d center;              // px, the mean of the pixels' positions
  double area = 0.0;               // px, the number of pixels: holes do not count
  std::vector<cv::Point> outline;  // px, the pixels along the outer border (cv::CHAIN_APPROX_SIMPLE)
  cv::Point2d circle_center;       // px, of the smallest circle around the outline
  double circle_radius = 0.0;      // px, of that circle, which goes through pixel centres; 0 for a single pixel
  double roundness = 0.0;          // area / area of the circle with half a pixel more radius, 0 to 1 (a disc)
};

/// Finds the regions of a mask by cv::morphologyEx, connected components and cv::findContours, all applied only to the
/// part of the mask that is not black. Threads may share a RegionFinder, because it never changes.
class RegionFinder
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit RegionFinder(const RegionParams& params = RegionParams());

  /// Finds the regions of `mask` (CV_8UC1, 0 and 255), the largest first; of more than kMaxRegions these. The mask is
  /// cleaned in place: opened, then closed. Throws std::invalid_argument if `mask` is empty or of another type.
  std::vector<Region> apply(cv::Mat& mask) const;

  /// The same for a mask that is known to be black outside of `part`; the rest is not looked at.
  std::vector<Region> apply(cv::Mat& mask, const cv::Rect& part) const;

  static constexpr std::size_t kMaxRegions = 1000;

private:
  /// Opens and closes the mask, and returns the part outside of which it is black now.
  cv::Rect clean(cv::Mat& mask, const cv::Rect& part) const;

  RegionParams params_;
  cv::Mat opening_;  // structuring elements
  cv::Mat closing_;
};

}  // namespace robot_vision
