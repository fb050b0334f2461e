#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/bit_kernels.hpp"
#include "core/image/gaussian_filter_rows.hpp"
#include "core/image/gray_line_buffer.hpp"
#include "frame_difference.hpp"

namespace robot_vision
{

/// A picture to compare with a reference.
struct MotionComparison
{
  EncodedPicture picture;
  Reference reference;
  const GaussWeights* blur;
  std::uint8_t threshold;
  int dilate;  // px
};

/// Some rows of the mask of what moves. Each row goes from the pictures to the mask while it is in the processor's
/// cache, and is blurred only where a pixel that differs is near.
class MotionStripe
{
public:
  /// Writes these rows of a mask. Returns a part of them outside of which they are black.
  cv::Rect run(const MotionComparison& comparison, const cv::Range& rows, cv::Mat& mask);

private:
  using Word = BitWord;

  void begin(const MotionComparison& comparison, int first);
  void makeNext(const MotionComparison& comparison);
  void compareTo(const MotionComparison& comparison, int end);
  void findSpans(const MotionComparison& comparison);
  void mark(const MotionComparison& comparison, int i);
  Word* dilated(int y) { return dilated_[y % window_]; }

  GrayLineBuffer gray_;
  GrayLineBuffer reference_gray_;
  GaussianFilterRows blurred_;
  GaussianFilterRows reference_blurred_;
  int words_ = 0;                 // of a row
  std::vector<int> changed_;      // the last row in which gray pixels of a block differ
  int compared_ = 0;              // the first row that is not in `changed_`
  int assumed_ = 0;               // the first row before which all blocks are assumed to differ
  std::vector<cv::Range> spans_;  // to be blurred in some rows
  AlignedRows<Word> marked_;      // two rows of bits to work with
  AlignedRows<Word> dilated_;     // blurred pixels that differ, dilated along the row, each in row y % window_
  int window_ = 1;                // rows that a dilation looks at, and those that are made with the last of them
  int next_ = 0;                  // the first row that is not in `dilated_`
  std::vector<const Word*> united_;
  std::vector<Word> mask_;  // a row of it
};

}  // namespace robot_vision
