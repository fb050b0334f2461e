#pragma once

#include <cstdint>
#include <vector>

#include "gray_line_buffer.hpp"

namespace robot_vision
{

/// The rows of a picture blurred by a box, from top to bottom: cv::blur with its default border, to the bit.
class BoxFilterRows
{
public:
  /// Of the gray rows, from row `first` on, with a box of `size` px: odd, to 31. `rows` have to stay, with a window of
  /// `size` + 1 rows.
  void begin(GrayLineBuffer& rows, int size, int first);

  /// Writes the next row.
  void next(std::uint8_t* means);

private:
  template <class Sum>
  struct Sums
  {
    std::vector<Sum> columns;  // of the rows around the next one; with half a box on both sides
    std::vector<Sum> boxes;
    std::vector<std::uint8_t> nothing;  // a black row
  };

  template <class Sum>
  void start(Sums<Sum>& sums);
  template <class Sum>
  void blur(Sums<Sum>& sums, std::uint8_t* means);
  template <class Sum>
  const Sum* addUp(Sums<Sum>& sums);

  GrayLineBuffer* rows_ = nullptr;
  int size_ = 1;
  int y_ = 0;  // the next row
  Sums<std::uint16_t> narrow_;
  Sums<std::uint32_t> wide_;  // of boxes whose sums do not fit 16 bits
};

}  // namespace robot_vision
