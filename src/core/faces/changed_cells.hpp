#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Tells roughly where an image has changed: in the cells whose mean gray level has.
class ChangedCells
{
public:
  /// `cell` is the side of a cell, px.
  explicit ChangedCells(int cell) : cell_(cell) {}

  /// Notes where the image (CV_8UC1) differs from the one before.
  void update(const cv::Mat& gray);

  /// Forgets what has changed in a part of the image, px.
  void ignore(const cv::Rect& part);

  /// Forgets all changes.
  void clear() { changed_.setTo(0); }

  /// Boxes (px) around what has changed since the last call, each `border` px larger on all sides. They do not overlap.
  std::vector<cv::Rect> take(int border);

private:
  int cell_;
  cv::Size image_size_;
  cv::Mat last_;      // the mean of each cell
  cv::Mat changed_;   // 255 where a cell has changed
  cv::Point2d size_;  // px, of a cell
};

}  // namespace robot_vision
