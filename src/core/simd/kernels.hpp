#pragma once

#include <cstdint>
#include <vector>

namespace robot_vision
{

struct HsvTests;

constexpr std::uint8_t kUnsure = 1;        // of Kernels::hsv
constexpr std::uint8_t kCandidate = 0x01;  // of Kernels::suppress
constexpr std::uint8_t kStrong = 0x80;

/// The quotient of a sum and an odd `divisor` from 3 on, rounded: (sum + half) * factor / 2^(16 + shift), for sums to
/// 255 * divisor.
struct Division
{
  explicit Division(int divisor);

  std::uint16_t half;
  std::uint16_t factor;
  int shift;
};

/// Thresholds of the gradient's magnitude, to be exceeded.
struct EdgeThresholds
{
  std::int32_t low;
  std::int32_t high;
};

/// Rows of gradients with a magnitude on each side of every row: what Kernels::suppress looks at.
template <class Magnitude>
struct Gradients
{
  const Magnitude* above;
  const Magnitude* row;
  const Magnitude* below;
  const std::int16_t* dx;
  const std::int16_t* dy;
};

/// What is added to the sums of Kernels::weigh_columns, which then fit signed words, and what that makes, with the half
/// for rounding, of the sum of 256 times as much.
constexpr int kSumBias = 0x8000;
constexpr int kMeanOffset = 256 * kSumBias + 0x8000;

using BitWord = std::uint64_t;  // of kWordBits pixels, from the lowest bit on
constexpr int kWordBits = 64;

constexpr int kWeighedRows = 4;   // that Kernels::weigh_columns makes at once
constexpr int kWeightMargin = 8;  // zeros before and after weights, which are read in twos and fours

/// The weights of a window's pixels from end to end, in 256ths, the same from both ends; twice, as both are used.
struct SymmetricWeights
{
  int half;  // of the window without its middle; at least 1
  const std::uint8_t* bytes;
  const std::uint16_t* words;

  /// Rows of a picture that kWeighedRows rows of sums are made of: as many more as make them fours.
  static constexpr int rows(int half) { return (2 * half + kWeighedRows + 3) / 4 * 4; }
};

/// The weights of a colour's channels in its grey, 0 to 32639 each, 2^shift together.
struct GrayWeights
{
  std::int16_t channels[3];
  int shift;
};

/// How a row of YUV has its chroma, of which pairs of pixels have one sample: between the luma, or in rows of its own,
/// as pairs (in `u` of YuvRow) or in two planes.
enum class YuvLayout
{
  kYuyv,
  kUyvy,
  kUv,
  kVu,
  kPlanes
};

struct YuvRow
{
  const std::uint8_t* luma;
  const std::uint8_t* u;
  const std::uint8_t* v;
};

/// A row of a Bayer mosaic with its neighbours, from its second pixel on.
struct BayerRow
{
  const std::uint8_t* above;
  const std::uint8_t* row;
  const std::uint8_t* below;
  bool green_first;  // whether `row` points at a green pixel
  bool third;        // whether its other pixels are of the third channel of the result, else of the first
};

constexpr int kLeastRow = 64;  // pixels that a row of Kernels::yuv and Kernels::bayer has

/// Loops over a row of pixels, compiled for one instruction set. Rows that are written overlap no others, unless said.
struct Kernels
{
  const char* name;  // of the instruction set

  /// sums += entering - leaving
  void (*slide16)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint16_t* sums);
  void (*slide32)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint32_t* sums);

  /// Of `part`, the sums of `width` neighbours in `single` (the one with the index and those after it), those of twice
  /// as many, and of one more if `odd`. `wider` may be `part`.
  void (*widen16)(const std::uint16_t* single, const std::uint16_t* part, int width, bool odd, int count,
                  std::uint16_t* wider);
  void (*widen32)(const std::uint32_t* single, const std::uint32_t* part, int width, bool odd, int count,
                  std::uint32_t* wider);

  /// (sum + half) * factor >> (16 + shift)
  void (*divide16)(const std::uint16_t* sums, const Division& by, int count, std::uint8_t* quotients);
  /// sum * factor, rounded
  void (*divide32)(const std::uint32_t* sums, float factor, int count, std::uint8_t* quotients);

  /// The 3x3 Sobel derivatives and their magnitude, |dx| + |dy| (16 bits) or dx^2 + dy^2 (32 bits); there is a pixel
  /// before and after each row that is read.
  void (*gradient16)(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int count,
                     std::int16_t* dx, std::int16_t* dy, std::int16_t* magnitude);
  void (*gradient32)(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int count,
                     std::int16_t* dx, std::int16_t* dy, std::int32_t* magnitude);

  /// Non-maximum suppression as cv::Canny does it: 0, kCandidate, or kCandidate | kStrong.
  void (*suppress16)(const Gradients<std::int16_t>& gradients, const EdgeThresholds& thresholds, int count,
                     std::uint8_t* marks);
  void (*suppress32)(const Gradients<std::int32_t>& gradients, const EdgeThresholds& thresholds, int count,
                     std::uint8_t* marks);

  /// value * gain + offset, rounded (halves to even) and limited to 0 to 255
  void (*line)(const std::uint8_t* values, float gain, float offset, int count, std::uint8_t* results);

  /// Values' places in a table of 256.
  void (*look_up)(const std::uint8_t* table, const std::uint8_t* values, int count, std::uint8_t* results);
  bool has_fast_look_up;  // faster than to compute

  /// kSumBias and the weighed sum of the pixels above each other in 2 * half + 1 rows: of those that begin with the
  /// first row, and with the three after it. Rows that only make fours of them have to be there, too.
  void (*weigh_columns)(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count,
                        std::uint16_t* const* sums);
  /// The weighed mean, rounded, of such sums: of pixel i from i to i + 2 * half. Reads up to 128 sums and writes up to
  /// 64 means more.
  void (*weigh_row)(const std::uint16_t* sums, const SymmetricWeights& weights, int count, std::uint8_t* means);

  /// Bits of pixels where two rows differ by more than the threshold; those beyond the last pixel are 0.
  void (*mark_differences)(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold, int count,
                           BitWord* bits);
  /// Those of the pixels of so many words that have kCandidate and kStrong.
  void (*split_marks)(const std::uint8_t* marks, int words, BitWord* candidates, BitWord* strong);
  /// Bits that any of at least one row has.
  void (*unite)(const BitWord* const* rows, int number, int words, BitWord* united);
  /// Bits, and those as many places (1 to 63) before and after them. The words before and after the row's are 0.
  void (*unite_neighbours)(const BitWord* bits, int words, int places, BitWord* united);
  /// 255 for pixels whose bit is 1, else 0.
  void (*spread_bits)(const BitWord* bits, int count, std::uint8_t* bytes);

  /// 255, 0 or kUnsure for pixels of three bytes in the order that the hue limits have.
  void (*hsv)(const HsvTests& tests, const std::uint8_t* pixels, int count, std::uint8_t* mask);

  /// The weighed sums of pixels of 3 or 4 channels, the fourth of which does not count, rounded (halves up). Null: not
  /// faster than cv::cvtColor.
  void (*gray)(const std::uint8_t* pixels, int channels, const GrayWeights& weights, int count, std::uint8_t* gray);

  /// The first of every two.
  void (*every_second)(const std::uint8_t* values, int count, std::uint8_t* results);
  /// Pixels in BGR or RGB order, as cv::cvtColor makes them. Null: not faster than that.
  void (*yuv)(const YuvRow& row, YuvLayout layout, int pairs, bool is_rgb, std::uint8_t* pixels);
  void (*bayer)(const BayerRow& row, int count, std::uint8_t* pixels);
};

/// Those that this machine can run, the best first.
const std::vector<const Kernels*>& availableKernels();

/// The best of them, or those chosen.
const Kernels& kernels();

/// For tests: makes kernels() return these; null: the best. Not while others work.
void chooseKernels(const Kernels* chosen);

}  // namespace robot_vision
