#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace robot_vision
{

/// Pixels by their gray level.
using GrayCounts = std::array<int, 256>;

/// Counts gray levels. Each byte of a word has counters of its own: neighbouring pixels are often equal, and would wait
/// for each other if they shared a counter.
class GrayHistogram
{
public:
  void add(const std::uint8_t* row, int count)
  {
    int i = 0;
    for (; i + kWordBytes <= count; i += kWordBytes)
    {
      std::uint64_t word;
      std::memcpy(&word, row + i, sizeof word);
      for (int byte = 0; byte < kWordBytes; ++byte)
        ++counts_[byte][word >> (8 * byte) & 0xFF];
    }
    for (; i < count; ++i)
      ++counts_[0][row[i]];
  }

  void addTo(GrayCounts& sums) const
  {
    for (const GrayCounts& counts : counts_)
      for (std::size_t i = 0; i < sums.size(); ++i)
        sums[i] += counts[i];
  }

private:
  static constexpr int kWordBytes = 8;

  std::array<GrayCounts, kWordBytes> counts_ = {};
};

}  // namespace robot_vision
