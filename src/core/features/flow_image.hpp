#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Parameters of optical flow; see the fields of the same names in ObjectTrackerParams, and of MatchParams.
struct FlowParams
{
  int window = 15;
  int levels = 3;
  double max_error = 1.0;
};

/// A gray image with its pyramid, which is built when it is first asked for, and kept until the next image.
class FlowImage
{
public:
  /// Copies a CV_8UC1 image, into memory that is kept from one image to the next.
  void set(const cv::Mat& gray);

  bool empty() const { return gray_.empty(); }
  cv::Size size() const { return gray_.size(); }
  const cv::Mat& gray() const { return gray_; }

  /// The pyramid of cv::buildOpticalFlowPyramid, in which the derivatives follow each image.
  const std::vector<cv::Mat>& pyramid(const FlowParams& params);

  /// The image halved `halvings` times. If the pyramid has fewer levels, `halvings` becomes the number that it has.
  const cv::Mat& halved(const FlowParams& params, int& halvings);

private:
  cv::Mat gray_;
  std::vector<cv::Mat> pyramid_;
  int window_ = 0, levels_ = 0;  // parameters that the pyramid was built for
  bool built_ = false;
};

struct FollowedPoints
{
  std::vector<cv::Point2f> positions;  // px, in the next image
  std::vector<uchar> found;            // 1 if following the point there and back led to where it was, else 0
  std::vector<float> errors;           // px, between where that led and where it was
};

/// Follows points from the last image to the next one by pyramidal Lucas-Kanade flow, which begins at `guess`. Points
/// may be found somewhat outside of the image.
FollowedPoints followPoints(FlowImage& last, FlowImage& next, const FlowParams& params,
                            const std::vector<cv::Point2f>& points, const std::vector<cv::Point2f>& guess);

/// Whether a point is between the centres of an image's outermost pixels.
bool isInside(const cv::Size& image, const cv::Point2f& p);

}  // namespace robot_vision
