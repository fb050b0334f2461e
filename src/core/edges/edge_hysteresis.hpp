#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/image/bit_kernels.hpp"

namespace robot_vision
{

/// The hysteresis of Canny's edge detector: keeps the candidates that are connected to a strong one (8-connectivity).
///
/// Each pixel is a bit of a 64-bit word, so that a few operations fill a row's runs of candidates. The rows are swept
/// once downwards and once upwards. Edges that wind are then completed word by word from a list, to which a word is
/// added only when it has gained a bit, so that the work is bounded by the number of candidates.
class EdgeHysteresis
{
public:
  /// Begins an image of this size. All its rows must then be set.
  void reset(cv::Size size);

  /// Sets a row from what EdgeKernels::suppress has written, followed by zeros up to the next multiple of 64 bytes.
  /// Threads may set different rows at the same time.
  void setRow(int y, const std::uint8_t* marks);

  /// Makes edges of all candidates that are connected to edges.
  void connect();

  /// Writes the edges as 255 and the rest as 0 into `edges` (CV_8UC1, reused if it fits).
  void write(cv::Mat& edges) const;

private:
  std::size_t at(int y) const { return static_cast<std::size_t>(y + 1) * stride_ + 1; }
  /// Whether a word has candidates that are not edges yet. Most words have none.
  bool isOpen(std::size_t word) const { return candidates_[word] != edges_[word]; }
  bool spread(std::size_t word);
  void spreadFromList();

  cv::Size size_;
  std::size_t words_ = 0;            // in a row
  std::size_t stride_ = 0;           // words in a row with its margin
  std::vector<BitWord> candidates_;  // with a margin of zeros: a word on both sides of each row, a row above and below
  std::vector<BitWord> edges_;       // the same
  std::vector<std::size_t> gained_;  // indices of words that have gained edges, whose neighbours may gain some, too
};

}  // namespace robot_vision
