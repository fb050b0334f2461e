#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// How much of a point's blurred surroundings lies in an area, 0 to 1, and how that changes with the point, and with
/// the blur's sigma along x and y and their correlation.
struct BlurredArea
{
  double share;
  cv::Vec2d by_point, by_sigma;
  double by_correlation;
};

struct BlurredPoint
{
  BlurredArea white, known;  // the white cells; those, and the black ones
};

/// Square cells, black, white, or of any other colour, behind a Gaussian blur along their sides. All lengths in cells.
class BlurredGrid
{
public:
  /// CV_8UC1: 0, 255, or kFreeCell.
  explicit BlurredGrid(const cv::Mat& cells);

  /// At a point; `sigma` above 0, `correlation` of the blur between -1 and 1.
  BlurredPoint at(const cv::Point2d& point, const cv::Point2d& sigma, double correlation) const;

private:
  cv::Mat cells_;
  bool are_all_known_;
};

}  // namespace robot_vision
