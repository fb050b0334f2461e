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

/// A ring buffer of the last `Count` rows of an image.
template <class T, int Count>
class RowRing
{
public:
  /// Sets the width of the rows, and all pixels to 0.
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

/// The first part of Canny's edge detector, up to the edge candidates, for some rows of an image. Each row is processed
/// from the image to its candidates while it is in the processor's cache.
class CannyStripe
{
public:
  /// Sets these rows of `hysteresis`. The thresholds apply to the magnitude |dx| + |dy|, or dx^2 + dy^2 if `squared`.
  void run(const cv::Mat& image, const std::string& encoding, int blur_size, const EdgeThresholds& thresholds,
           bool squared, cv::Range rows, EdgeHysteresis& hysteresis);

private:
  template <class Magnitude>
  void run(const EdgeThresholds& thresholds, cv::Range rows, RowRing<Magnitude, 3>& magnitudes,
           EdgeHysteresis& hysteresis);
  void blurTo(int y);
  template <class Magnitude>
  void differentiate(int y, Magnitude* magnitudes);

  GrayLineBuffer gray_;
  BoxFilterRows<MirroredRows> box_;
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
