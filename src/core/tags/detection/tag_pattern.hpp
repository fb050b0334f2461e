#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "tag_library.hpp"

namespace robot_vision
{

/// What the tags of a family look like.
class TagPattern
{
public:
  explicit TagPattern(const apriltag_family_t& family);

  /// Correlation of a gray image with the cells of a tag in it, and with its borders, -1 to 1. `toPixels` brings the
  /// square of -1 to 1 between the tag's corners, y down, to pixels.
  double compare(const cv::Mat& gray, const cv::Matx33d& toPixels, std::uint64_t code) const;

private:
  struct Cell
  {
    cv::Point2d middle;  // in the square
    int bit;             // of the code, from its lowest; or one of the borders
  };

  std::vector<Cell> cells_;
  double quarter_;  // of a cell's side
};

}  // namespace robot_vision
