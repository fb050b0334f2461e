#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// White pixels of one row that lie side by side.
struct Run
{
  int y;
  int begin;  // x of the first pixel
  int end;    // x behind the last one
  int first;  // index of the first run of the same region
};

/// All runs in a part of a mask (CV_8UC1, white is what is not 0), row by row and from left to right. Runs of
/// neighbouring rows that touch at a side or a corner are of the same region. For areas and centres this is what
/// cv::connectedComponentsWithStats is for, which takes ten times as long: it visits pixels, not runs.
std::vector<Run> findRuns(const cv::Mat& mask, const cv::Rect& part);

/// The run that holds a white pixel.
const Run& runAt(const std::vector<Run>& runs, const cv::Point& pixel);

}  // namespace robot_vision
