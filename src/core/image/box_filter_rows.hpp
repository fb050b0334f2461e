#pragma once

#include <cstdint>
#include <vector>

#include "gray_line_buffer.hpp"

namespace robot_vision
{

/// Computes the rows of a box-filtered image from top to bottom, bit for bit as cv::blur does with its default border.
class BoxFilterRows
{
public:
  /// Begins at row `first` of the gray rows with a box of `size` px (odd, 1 to 31). `rows` must outlive the calls of
  /// next(), and have a window of `size` + 1 rows.
  void begin(GrayLineBuffer& rows, int size, int first);

  /// Writes the next row, which has as many pixels as the gray rows.
  void next(std::uint8_t* means);

private:
  template <class Sum>
  struct Sums
  {
    std::vector<Sum> columns;  // sums over the rows around the next one, with half a box more on both sides
    std::vector<Sum> boxes;    // sums over the boxes around the next row's pixels
    std::vector<std::uint8_t> black_row;
  };

  template <class Sum>
  void start(Sums<Sum>& sums);
  template <class Sum>
  void blur(Sums<Sum>& sums, std::uint8_t* means);
  template <class Sum>
  const Sum* sumBoxes(Sums<Sum>& sums);

  GrayLineBuffer* rows_ = nullptr;
  int size_ = 1;
  int y_ = 0;  // the next row
  Sums<std::uint16_t> narrow_;
  Sums<std::uint32_t> wide_;  // for boxes whose sums do not fit 16 bits
};

}  // namespace robot_vision
