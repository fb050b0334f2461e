#pragma once

#include <opencv2/core.hpp>

#include "pose_fit.hpp"
#include "rendered_region.hpp"
#include "robot_vision/recognition/pose_verifier.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

/// What the depth of a pixel says of an object that would be seen there.
enum PixelState : unsigned char
{
  kEmpty,     // the object would not be seen there
  kAgreeing,  // it is its surface
  kPierced,   // something behind its surface is seen
  kHidden,    // something before it is
  kUnknown,   // there is no depth
};

/// Compares the depths of a region with those of a frame.
class DepthAgreement
{
public:
  DepthAgreement(const DepthErrorParams& errors, double tolerance) : errors_(errors), tolerance_(tolerance) {}

  /// Fills in what depths say.
  void compare(const RenderedRegion& region, const RecognitionFrame& frame, PoseEvidence& evidence);

  /// CV_8UC1, of the pixels of the region: PixelState.
  const cv::Mat& states() const { return states_; }

private:
  void compareRow(const RenderedRegion& region, const RecognitionFrame& frame, int y);
  void count(double noise, PoseEvidence& evidence) const;
  double normalAgreement(const RenderedRegion& region) const;
  double sunkenBorder(const RenderedRegion& region, const RecognitionFrame& frame, double noise) const;

  DepthErrorParams errors_;
  double tolerance_;
  cv::Mat states_;
  cv::Mat differences_;  // CV_32FC1, m, measured minus drawn, where they agree
  cv::Mat deviations_;   // CV_32FC1, m, of the differences
};

}  // namespace robot_vision
