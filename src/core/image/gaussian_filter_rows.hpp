#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "aligned_rows.hpp"
#include "gauss_kernels.hpp"
#include "gray_line_buffer.hpp"

namespace robot_vision
{

/// The weights by which cv::GaussianBlur makes a mean of bytes.
class GaussWeights
{
public:
  /// Of a window with this odd side, from 1 px on, and the sigma that OpenCV takes for it.
  explicit GaussWeights(int size);

  int size() const { return size_; }
  /// Of the window without its middle, as far as it has weights.
  int half() const { return half_; }
  /// Where half() is not 0.
  SymmetricWeights weights() const { return {half_, bytes_.data() + kWeightMargin, words_.data() + kWeightMargin}; }

  /// Tries whether GaussianFilterRows make what cv::GaussianBlur does, to the bit. They do not if OpenCV's weights do
  /// not add up to 1, as before 4.5.
  bool areExact() const;

private:
  int size_;
  int half_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint16_t> words_;
};

/// Rows of a gray picture after cv::GaussianBlur, from top to bottom.
class GaussianFilterRows
{
public:
  static constexpr int kColumns = 64;  // at multiples of which spans begin

  /// `rows` and `weights` have to stay; `rows` has to be begun from the first row of the first window on, with a window
  /// of window() rows.
  void begin(GrayLineBuffer& rows, const GaussWeights& weights);

  /// Begins kWeighedRows rows from row `y` on, which is not above the last call's, in these columns.
  void begin(int y, const std::vector<cv::Range>& spans);

  /// One of these rows; valid until the next one.
  const std::uint8_t* row(int i);

  /// Rows of the picture that are looked at together.
  static int window(const GaussWeights& weights) { return SymmetricWeights::rows(weights.half()); }

private:
  void convolveColumns(const cv::Range& span);

  GrayLineBuffer* rows_ = nullptr;
  const GaussWeights* weights_ = nullptr;
  std::vector<const std::uint8_t*> window_;
  std::vector<const std::uint8_t*> columns_;  // the same rows from a span's first column on
  AlignedRows<std::uint16_t> sums_;           // of the columns, with those that are mirrored beyond both ends
  std::vector<cv::Range> spans_;
  AlignedRows<std::uint8_t> means_;  // one row
};

}  // namespace robot_vision
