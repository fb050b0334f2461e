#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/bit_kernels.hpp"
#include "core/image/gaussian_filter_rows.hpp"
#include "core/image/gray_line_buffer.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

/// What images are compared with.
struct Reference
{
  cv::Mat gray;     // CV_8UC1
  cv::Mat blurred;  // the same blurred; if empty, `gray` is blurred in each comparison, where that is needed
};

/// An image to compare with a reference.
struct MotionComparison
{
  EncodedImage image;
  Reference reference;
  const GaussWeights* blur;
  std::uint8_t threshold;
  int dilate;  // px
};

/// Computes some rows of the mask of what moves, one after the other: each is made gray, blurred, compared and dilated
/// while it is in the processor's cache. It is blurred only near pixels that differ.
class MotionStripe
{
public:
  /// Writes these rows of a mask. Returns the part of them outside of which they are black.
  cv::Rect run(const MotionComparison& comparison, const cv::Range& rows, cv::Mat& mask);

private:
  void begin(const MotionComparison& comparison, int first);
  void makeNext(const MotionComparison& comparison);
  void compareTo(const MotionComparison& comparison, int end);
  void findSpans(const MotionComparison& comparison);
  void mark(const MotionComparison& comparison, int i);
  BitWord* dilated(int y) { return dilated_[y % window_]; }

  GrayLineBuffer gray_;
  GrayLineBuffer reference_gray_;
  GaussianFilterRows blurred_;
  GaussianFilterRows reference_blurred_;
  int words_ = 0;                 // in a row of bits, one for each block
  std::vector<int> changed_;      // for each block the last row in which its gray pixels differ
  int compared_ = 0;              // the first row that is not in `changed_`
  int assumed_ = 0;               // all blocks of the rows before it are assumed to differ
  std::vector<cv::Range> spans_;  // columns to be blurred in the next rows
  AlignedRows<BitWord> marked_;   // two rows of bits to work with
  AlignedRows<BitWord> dilated_;  // bits of blurred pixels that differ, dilated along the row; row y is y % window_
  int window_ = 1;                // rows that a dilation needs, and those that are made together with the last of them
  int next_ = 0;                  // the first row that is not in `dilated_`
  std::vector<const BitWord*> united_;  // the rows that are dilated to one
  std::vector<BitWord> mask_;           // the bits of a row of the mask
};

}  // namespace robot_vision
