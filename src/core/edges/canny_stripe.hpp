#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/box_filter_rows.hpp"
#include "core/image/gray_line_buffer.hpp"
#include "edge_hysteresis.hpp"
#include "edge_kernels.hpp"

namespace robot_vision
{

/// `Count` rows of a picture, each used again for the row that is `Count` below it.
template <class T, int Count>
class RowRing
{
public:
  /// To zeros.
  void resize(int width)
  {
    rows_.resize(Count, width);
    rows_.fill(T());
  }

  /// The first pixel of row `y`, which is at least -1.
  T* operator[](int y) { return rows_[(y + Count) % Count]; }

private:
  AlignedRows<T> rows_;
};

/// The first part of Canny's edge detector for some rows of a picture, up to the candidates for edges. Each row goes
/// from the picture to its candidates while it is in the processor's cache.
class CannyStripe
{
public:
  /// Sets these rows of `bits`. The thresholds are those of the magnitude: |dx| + |dy|, or dx^2 + dy^2 if `squared`.
  void run(const cv::Mat& image, const std::string& encoding, int blur_size, const EdgeThresholds& thresholds,
           bool squared, cv::Range rows, EdgeHysteresis& bits);

private:
  template <class Magnitude>
  void run(const EdgeThresholds& thresholds, cv::Range rows, RowRing<Magnitude, 3>& magnitudes, EdgeHysteresis& bits);
  void blurTo(int y);
  template <class Magnitude>
  void differentiate(int y, Magnitude* magnitudes);

  GrayLineBuffer gray_;
  BoxFilterRows box_;
  cv::Size size_;
  int next_blurred_ = 0;
  RowRing<std::uint8_t, 3> blurred_;
  RowRing<std::int16_t, 2> dx_;
  RowRing<std::int16_t, 2> dy_;
  RowRing<std::int16_t, 3> sums_;     // |dx| + |dy|
  RowRing<std::int32_t, 3> squares_;  // dx^2 + dy^2
  std::vector<std::uint8_t> marks_;
};

}  // namespace robot_vision
