#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "aligned_rows.hpp"
#include "gray_rows.hpp"
#include "kernels/kernels.hpp"

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
  SymmetricWeights weights() const { return {half_, values_.data(), pairs_.data()}; }

  /// Tries whether GaussRows make what cv::GaussianBlur does, to the bit. They do not if OpenCV's weights do not add up
  /// to 1, as before 4.5.
  bool areExact() const;

private:
  int size_;
  int half_;
  std::vector<std::uint16_t> values_;
  std::vector<std::int32_t> pairs_;
};

/// The rows of a grey picture after cv::GaussianBlur, from top to bottom.
class GaussRows
{
public:
  /// From row `first` on. `rows` and `weights` have to stay; `rows` has to be begun from the first row of the first
  /// window on, with a window of window() rows.
  void begin(GrayRows& rows, const GaussWeights& weights, int first);

  /// The next row; valid until the next call. There are 64 more pixels, which mean nothing.
  const std::uint8_t* next();

  /// Rows that the blur of one looks at.
  static int window(const GaussWeights& weights) { return 2 * weights.half() + 1; }

private:
  GrayRows* rows_ = nullptr;
  const GaussWeights* weights_ = nullptr;
  int y_ = 0;
  std::vector<const std::uint8_t*> window_;
  AlignedRows<std::uint16_t> sums_;  // one row, of the columns, with those that are mirrored beyond both ends
  AlignedRows<std::uint8_t> means_;  // one row
};

}  // namespace robot_vision
