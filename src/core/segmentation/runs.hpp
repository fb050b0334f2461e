#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// A sequence of neighbouring white pixels in one row.
struct Run
{
  int y;
  int begin;  // x of the first pixel
  int end;    // x of the last pixel, plus 1
  int first;  // index of the first run of the same region
};

/// Finds all runs in a part of a mask (CV_8UC1; all values but 0 are white), row by row and from left to right. Runs of
/// neighbouring rows that touch at a side or a corner belong to the same region. Areas and centres computed from runs
/// equal those of cv::connectedComponentsWithStats, which takes ten times as long because it visits each pixel.
std::vector<Run> findRuns(const cv::Mat& mask, const cv::Rect& part);

/// The run that holds a white pixel.
const Run& runAt(const std::vector<Run>& runs, const cv::Point& pixel);

}  // namespace robot_vision
