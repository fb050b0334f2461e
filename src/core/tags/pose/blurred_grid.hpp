#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// The share of the blur around a point that lies in an area, 0 to 1, with its derivatives by the point, by the blur's
/// sigma along x and y, and by the correlation of the two.
struct BlurredArea
{
  double share;
  cv::Vec2d by_point, by_sigma;
  double by_correlation;
};

struct BlurredPoint
{
  BlurredArea white, known;  // of the white cells; of the white and the black ones
};

/// Square cells that are black, white or unknown, seen through a Gaussian blur. All lengths are in cells.
class BlurredGrid
{
public:
  /// `cells` is CV_8UC1 with the values 0, 255 and kFreeCell (unknown).
  explicit BlurredGrid(const cv::Mat& cells);

  /// The shares at a point for a blur with `sigma` (above 0) along x and y and their `correlation` (-1 to 1).
  BlurredPoint at(const cv::Point2d& point, const cv::Point2d& sigma, double correlation) const;

private:
  cv::Mat cells_;
  bool all_known_;
};

}  // namespace robot_vision
