// Runs kernels on rows that end where their memory ends, so that the sanitizers see accesses beyond them. In the
// library many rows have margins, which would hide such accesses.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include "core/edges/edge_kernels.hpp"
#include "core/image/bit_kernels.hpp"
#include "core/image/box_kernels.hpp"
#include "core/image/gauss_kernels.hpp"

using namespace robot_vision;

namespace
{

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<BitWord>;

constexpr int kCounts[] = {1, 2, 7, 15, 16, 17, 31, 33, 63, 64, 65, 100, 127, 128, 129, 200, 321};

int wordsOf(int count)
{
  return (count + kWordBits - 1) / kWordBits;
}

template <class T>
std::vector<T> random(int count, int largest)
{
  static std::mt19937 generator(7);
  std::vector<T> values(static_cast<std::size_t>(count));
  for (T& value : values)
    value = static_cast<T>(generator() % (static_cast<unsigned>(largest) + 1));
  return values;
}

Words randomBits(int words)
{
  Words bits = random<BitWord>(words, 0x7FFFFFFF);
  for (BitWord& word : bits)
    word *= 0x9E3779B97F4A7C15U;
  return bits;
}

bool bitAt(const Words& bits, int i)
{
  return i >= 0 && i / kWordBits < static_cast<int>(bits.size()) &&
         (bits[static_cast<std::size_t>(i / kWordBits)] >> i % kWordBits & 1) != 0;
}

Words bitsOf(const Bytes& bytes)
{
  Words bits(static_cast<std::size_t>(wordsOf(static_cast<int>(bytes.size()))), 0);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    if (bytes[i] != 0) bits[i / kWordBits] |= BitWord{1} << i % kWordBits;
  return bits;
}

std::vector<const std::uint8_t*> pointersTo(const std::vector<Bytes>& rows)
{
  std::vector<const std::uint8_t*> pointers;
  for (const Bytes& row : rows)
    pointers.push_back(row.data());
  return pointers;
}

}  // namespace

TEST(RowEnds, markDifferencesAndSpreadBits)
{
  for (const int count : kCounts)
  {
    const Bytes a = random<std::uint8_t>(count, 255);
    const Bytes b = random<std::uint8_t>(count, 255);
    Bytes differ(a.size());
    std::transform(a.begin(), a.end(), b.begin(), differ.begin(),
                   [](int x, int y) { return static_cast<std::uint8_t>(std::abs(x - y) > 100 ? 1 : 0); });
    Words bits(static_cast<std::size_t>(wordsOf(count)));
    kernels<BitKernels>().mark_differences(a.data(), b.data(), 100, count, bits.data());
    EXPECT_EQ(bits, bitsOf(differ)) << count;

    Bytes spread(a.size());
    kernels<BitKernels>().spread_bits(bits.data(), count, spread.data());
    for (int i = 0; i < count; ++i)
      ASSERT_EQ(spread[static_cast<std::size_t>(i)], bitAt(bits, i) ? 255 : 0) << count << ", " << i;
  }
}

TEST(RowEnds, splitMarks)
{
  constexpr std::uint8_t kMarks[] = {0, kCandidate, kCandidate | kStrong};
  for (const int words : {1, 2, 5})
  {
    Bytes marks = random<std::uint8_t>(words * kWordBits, 2);
    Bytes candidates, strong;
    for (std::uint8_t& mark : marks)
    {
      mark = kMarks[mark];
      candidates.push_back(mark & kCandidate);
      strong.push_back(mark & kStrong);
    }
    Words first(static_cast<std::size_t>(words)), second(first);
    kernels<BitKernels>().split_marks(marks.data(), words, first.data(), second.data());
    EXPECT_EQ(first, bitsOf(candidates)) << words;
    EXPECT_EQ(second, bitsOf(strong)) << words;
  }
}

TEST(RowEnds, unite)
{
  for (const int words : {1, 2, 3, 5, 8, 9, 30})
  {
    const std::vector<Words> rows = {randomBits(words), randomBits(words), randomBits(words)};
    const BitWord* const pointers[] = {rows[0].data(), rows[1].data(), rows[2].data()};
    for (const int number : {1, 3})
    {
      Words united(rows[0].size());
      kernels<BitKernels>().unite(pointers, number, words, united.data());
      for (std::size_t i = 0; i < united.size(); ++i)
        ASSERT_EQ(united[i], number == 1 ? rows[0][i] : rows[0][i] | rows[1][i] | rows[2][i]);
    }
    Words between = rows[0];
    between.insert(between.begin(), 0);
    between.push_back(0);
    for (const int places : {1, 2, 31, 63})
    {
      Words united(rows[0].size());
      kernels<BitKernels>().unite_neighbours(between.data() + 1, words, places, united.data());
      for (int i = 0; i < words * kWordBits; ++i)
        ASSERT_EQ(bitAt(united, i), bitAt(rows[0], i) || bitAt(rows[0], i - places) || bitAt(rows[0], i + places))
            << words << places;
    }
  }
}

TEST(RowEnds, convolveColumnsAndRows)
{
  constexpr std::size_t kReadBeyond = 128, kWrittenBeyond = 64;  // as GaussKernels::convolve_row says
  const std::vector<std::vector<std::uint8_t>> windows = {
      {64, 128, 64}, {1, 20, 60, 94, 60, 20, 1}, {64, 64, 0, 64, 64}};
  for (const Bytes& window : windows)
    for (const int count : kCounts)
    {
      Bytes bytes(kWeightMargin, 0);
      bytes.insert(bytes.end(), window.begin(), window.end());
      bytes.resize(bytes.size() + kWeightMargin, 0);
      const std::vector<std::uint16_t> words(bytes.begin(), bytes.end());
      const int half = static_cast<int>(window.size()) / 2;
      const SymmetricWeights weights{half, bytes.data() + kWeightMargin, words.data() + kWeightMargin};

      std::vector<Bytes> rows;
      for (int i = 0; i < SymmetricWeights::rows(half); ++i)
        rows.push_back(random<std::uint8_t>(count, 255));
      std::vector<std::vector<std::uint16_t>> sums(kRowsAtOnce, std::vector<std::uint16_t>(rows[0].size()));
      std::uint16_t* const to[] = {sums[0].data(), sums[1].data(), sums[2].data(), sums[3].data()};
      kernels<GaussKernels>().convolve_columns(pointersTo(rows).data(), weights, count, to);
      for (std::size_t k = 0; k < sums.size(); ++k)
        for (std::size_t x = 0; x < rows[0].size(); ++x)
        {
          int sum = kSumBias;
          for (std::size_t j = 0; j < window.size(); ++j)
            sum += window[j] * rows[k + j][x];
          ASSERT_EQ(sums[k][x], sum & 0xFFFF) << half << ", " << count << ", row " << k << ", " << x;
        }

      for (const std::size_t channels : {1U, 3U, 4U})
      {
        const auto taps = random<std::uint16_t>(count + 2 * half * static_cast<int>(channels), 255 * 256);
        std::vector<std::uint16_t> biased;
        for (const std::uint16_t tap : taps)
          biased.push_back(static_cast<std::uint16_t>(tap + kSumBias));
        biased.resize(biased.size() + kReadBeyond, 0x1234);
        Bytes means(rows[0].size() + kWrittenBeyond);
        kernels<GaussKernels>().convolve_row(biased.data(), weights, static_cast<int>(channels), count, means.data());
        for (std::size_t x = 0; x < rows[0].size(); ++x)
        {
          int sum = 0x8000;
          for (std::size_t j = 0; j < window.size(); ++j)
            sum += window[j] * taps[x + j * channels];
          ASSERT_EQ(means[x], sum >> 16) << half << ", " << count << ", " << channels << " channels, " << x;
        }
      }
    }
}

TEST(RowEnds, slideAndDivide)
{
  const BoxDivision by_nine(9);
  for (const int count : kCounts)
  {
    const Bytes entering = random<std::uint8_t>(count, 255), leaving = random<std::uint8_t>(count, 255);
    const auto before = random<std::uint16_t>(count, 8 * 255);
    std::vector<std::uint16_t> sums(before);
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] = static_cast<std::uint16_t>(before[i] + leaving[i]);
    kernels<BoxKernels<std::uint16_t>>().slide(entering.data(), leaving.data(), count, sums.data());
    Bytes quotients(sums.size());
    kernels<BoxKernels<std::uint16_t>>().divide(sums.data(), by_nine, count, quotients.data());
    for (std::size_t i = 0; i < sums.size(); ++i)
    {
      ASSERT_EQ(sums[i], before[i] + entering[i]) << count << ", " << i;
      ASSERT_EQ(quotients[i], (2 * sums[i] + 9) / 18) << count << ", " << i;
    }
  }
}

TEST(RowEnds, gradient)
{
  for (const int count : kCounts)
  {
    const std::vector<Bytes> rows = {random<std::uint8_t>(count + 2, 255), random<std::uint8_t>(count + 2, 255),
                                     random<std::uint8_t>(count + 2, 255)};
    std::vector<std::int16_t> dx(static_cast<std::size_t>(count)), dy(dx), sums(dx);
    std::vector<std::int32_t> squares(dx.size());
    const auto row = [&rows](std::size_t i) { return rows[i].data() + 1; };
    kernels<EdgeKernels<std::int16_t>>().gradient(row(0), row(1), row(2), count, dx.data(), dy.data(), sums.data());
    for (int i = 0; i < count; ++i)
    {
      const auto column = [&](int x) { return row(0)[x] + 2 * row(1)[x] + row(2)[x]; };
      const auto along = [&](std::size_t y) { return row(y)[i - 1] + 2 * row(y)[i] + row(y)[i + 1]; };
      const auto place = static_cast<std::size_t>(i);
      ASSERT_EQ(dx[place], column(i + 1) - column(i - 1)) << count << ", " << i;
      ASSERT_EQ(dy[place], along(2) - along(0)) << count << ", " << i;
      ASSERT_EQ(sums[place], std::abs(dx[place]) + std::abs(dy[place])) << count << ", " << i;
    }
    kernels<EdgeKernels<std::int32_t>>().gradient(row(0), row(1), row(2), count, dx.data(), dy.data(), squares.data());
    for (std::size_t i = 0; i < dx.size(); ++i)
      ASSERT_EQ(squares[i], dx[i] * dx[i] + dy[i] * dy[i]) << count << ", " << i;
  }
}
