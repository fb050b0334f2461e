#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "aligned_rows.hpp"
#include "gauss_kernels.hpp"
#include "gray_line_buffer.hpp"

namespace robot_vision
{

/// The weights that cv::GaussianBlur uses for bytes.
class GaussWeights
{
public:
  /// Finds the weights for a window with this side (px, odd, at least 1). `sigma` is in px; 0: as OpenCV derives it
  /// from the size.
  explicit GaussWeights(int size, double sigma = 0.0);

  int size() const { return size_; }
  /// Pixels on each side of the window's middle whose weights are not 0.
  int half() const { return half_; }
  /// The weights for the kernels; half() must not be 0.
  SymmetricWeights weights() const { return {half_, bytes_.data() + kWeightMargin, words_.data() + kWeightMargin}; }

  /// Tries whether GaussianFilterRows equals cv::GaussianBlur to the bit. It does not where OpenCV's weights do not add
  /// up to 1, as before version 4.5.
  bool areExact() const;

private:
  int size_;
  double sigma_;
  int half_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint16_t> words_;
};

/// Computes rows of a gray image filtered by cv::GaussianBlur, from top to bottom and only in spans of columns.
class GaussianFilterRows
{
public:
  static constexpr int kColumns = 64;  // spans begin at multiples of it

  /// Begins an image. `rows` and `weights` must outlive the calls that follow; `rows` must begin at or above the first
  /// row of the first window, and have a window of window() rows.
  void begin(GrayLineBuffer& rows, const GaussWeights& weights);

  /// Begins kRowsAtOnce rows from row `y` on, in these columns. `y` must not be less than in the last call.
  void begin(int y, const std::vector<cv::Range>& spans);

  /// Row `i` of these, 0 to kRowsAtOnce - 1; valid until the next call.
  const std::uint8_t* row(int i);

  /// The number of gray rows that kRowsAtOnce filtered rows are computed from.
  static int window(const GaussWeights& weights) { return SymmetricWeights::rows(weights.half()); }

private:
  void convolveColumns(const cv::Range& span);

  GrayLineBuffer* rows_ = nullptr;
  const GaussWeights* weights_ = nullptr;
  std::vector<const std::uint8_t*> window_;
  std::vector<const std::uint8_t*> columns_;  // the same rows, from the first column of a span on
  AlignedRows<std::uint16_t> sums_;           // sums over columns, mirrored beyond both ends of the rows
  std::vector<cv::Range> spans_;
  AlignedRows<std::uint8_t> means_;  // one row
};

}  // namespace robot_vision
