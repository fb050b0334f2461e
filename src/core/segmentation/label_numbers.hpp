#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Which segments get which numbers.
struct NumberingRule
{
  double min_area;  // px
  int max_segments;
  bool by_size;  // the largest is 1; else the labels are the numbers
  bool keep;     // with by_size: a segment has the number of the one of the last image that it lies on
};

/// Gives the segments of one image after the other their numbers.
class LabelNumbers
{
public:
  /// The numbers (CV_16UC1) for labels (CV_32SC1, 0 and above; 0 stays 0). Of too many segments the largest are kept.
  cv::Mat apply(const cv::Mat& labels, const NumberingRule& rule);

private:
  /// The number of each of the segments, which are the labels in `order`, by the numbers of the last image.
  std::vector<int> keptNumbers(const cv::Mat& labels, const std::vector<int>& areas, const std::vector<int>& order);

  cv::Mat last_;  // CV_16UC1
};

}  // namespace robot_vision
