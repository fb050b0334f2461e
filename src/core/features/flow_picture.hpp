#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// What following points from one picture to the next takes; see ObjectTrackerParams.
struct FlowParams
{
  int window = 15;
  int levels = 3;
  double max_error = 1.0;
};

/// A gray picture with its pyramid, which is built when it is first asked for, and kept for the next frame.
class FlowPicture
{
public:
  /// Takes a copy of a CV_8UC1 picture; memory of before is used again.
  void set(const cv::Mat& gray);

  bool empty() const { return gray_.empty(); }
  cv::Size size() const { return gray_.size(); }
  const cv::Mat& gray() const { return gray_; }

  /// As cv::buildOpticalFlowPyramid makes it, with derivatives.
  const std::vector<cv::Mat>& pyramid(const FlowParams& params);

  /// The picture halved so many times, or as often as the pyramid has it; `halvings` becomes that.
  const cv::Mat& halved(const FlowParams& params, int& halvings);

private:
  cv::Mat gray_;
  std::vector<cv::Mat> pyramid_;
  int window_ = 0, levels_ = 0;  // that it was built for
  bool built_ = false;
};

/// Where the points of the last picture are in the next one, if they can be followed there and back.
struct FollowedPoints
{
  std::vector<cv::Point2f> positions;
  std::vector<uchar> found;
};

/// Follows points by pyramidal Lucas-Kanade flow; `guess` is where they may be.
FollowedPoints followPoints(FlowPicture& last, FlowPicture& next, const FlowParams& params,
                            const std::vector<cv::Point2f>& points, const std::vector<cv::Point2f>& guess);

}  // namespace robot_vision
