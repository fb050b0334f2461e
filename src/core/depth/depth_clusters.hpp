#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Finds pixels that hang together: those beside each other at a side or a corner, or with one other between them in a
/// row or column, whose depths differ by a gap at most.
class DepthClusters
{
public:
  /// `depths` is CV_32FC1, m; 0 for pixels that belong to none. Writes CV_32SC1 into `labels`, 1 for the first cluster,
  /// 2 for the second, ...; 0 for none. Returns the number of pixels of each cluster.
  std::vector<int> find(const cv::Mat& depths, float gap, cv::Mat& labels);

private:
  void join(int& label, int other);

  std::vector<int> parents_;  // of provisional labels; the root of a tree is its own
};

}  // namespace robot_vision
