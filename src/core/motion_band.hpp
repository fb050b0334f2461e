#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "aligned_rows.hpp"
#include "changed_pixels.hpp"
#include "gauss_rows.hpp"
#include "gray_rows.hpp"

namespace robot_vision
{

/// A picture to compare with a reference.
struct MotionComparison
{
  EncodedPicture picture;
  Reference reference;
  cv::Rect part;  // outside of which they do not differ
  const GaussWeights* blur;
  std::uint8_t threshold;
  int dilate;  // px
};

/// Some rows of the mask of what moves. Each row goes from the pictures to the mask while it is in the processor's
/// cache.
class MotionBand
{
public:
  /// Writes rows of a mask: those of `part` grown by the dilation, `rows` counted from the first of them.
  void run(const MotionComparison& comparison, const cv::Range& rows, cv::Mat& mask);

private:
  /// What is left to make: differences, dilated along their row, each in row y % window of `dilated_`.
  void begin(const MotionComparison& comparison, int first);
  void dilateNext(const MotionComparison& comparison);
  std::uint8_t* dilatedRow(int dilate, int y);

  GrayRows gray_;
  GrayRows reference_gray_;
  GaussRows blurred_;
  GaussRows reference_blurred_;
  cv::Rect outer_;                    // of the pictures, that the blur looks at
  cv::Rect grown_;                    // of the mask
  int next_ = 0;                      // row of the picture
  AlignedRows<std::uint8_t> marked_;  // a row of differences with black on both sides
  AlignedRows<std::uint8_t> dilated_;
  std::vector<const std::uint8_t*> united_;  // rows
};

}  // namespace robot_vision
