#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/image/bit_kernels.hpp"

namespace robot_vision
{

/// The hysteresis of Canny's edge detector: which candidates are connected to a strong one, by eight neighbours.
///
/// Pixels are bits, 64 to a word, so that a row's runs of candidates are filled by a few operations. Rows are swept
/// down and up once; what is left (an edge that winds) goes word by word through a list in which a word comes up only
/// when it has gained a bit: the work is bounded by the number of candidates, however dense they are.
class EdgeHysteresis
{
public:
  /// For a picture of this size; its marks are all to be set.
  void reset(cv::Size size);

  /// Sets a row by what EdgeKernels::suppress has written; different rows by several threads at a time. There are bytes
  /// to the next multiple of 64, which are 0.
  void setRow(int y, const std::uint8_t* marks);

  /// Makes an edge of every candidate that is connected to one.
  void connect();

  /// Writes 255 for edges, else 0, into CV_8UC1 of the size.
  void write(cv::Mat& edges) const;

private:
  using Word = BitWord;

  std::size_t at(int y) const { return static_cast<std::size_t>(y + 1) * stride_ + 1; }
  /// Whether it may gain anything; most words may not.
  bool isOpen(std::size_t word) const { return candidates_[word] != edges_[word]; }
  bool spread(std::size_t word);
  void spreadFromList();

  cv::Size size_;
  std::size_t words_ = 0;   // of a row
  std::size_t stride_ = 0;  // of a row with a word of zeros on both sides; there is a row of them above and below
  std::vector<Word> candidates_;
  std::vector<Word> edges_;
  std::vector<std::size_t> gained_;  // words whose neighbours have to be looked at
};

}  // namespace robot_vision
