#include "edge_bits.hpp"

#include <array>
#include <cstring>

#include "kernels/kernels.hpp"

namespace robot_vision
{
namespace
{

using Word = std::uint64_t;

constexpr int kBits = 64;
constexpr Word kLowest = 0x0101010101010101U;  // bit of each byte

Word load(const std::uint8_t* bytes)
{
  Word word;
  std::memcpy(&word, bytes, sizeof(word));
  return word;
}

/// The lowest bits of eight bytes, the first byte's lowest: each is multiplied to its place in the highest byte.
/// Bytes are in the order of their addresses from the lowest (as on all that ROS runs on).
Word gather(Word bytes)
{
  return (bytes & kLowest) * 0x0102040810204080U >> 56;
}

std::array<Word, 256> makeBytes()
{
  std::array<Word, 256> table = {};
  for (std::size_t bits = 0; bits < table.size(); ++bits)
    for (unsigned i = 0; i < 8; ++i)
      if ((bits >> i & 1) != 0) table[bits] |= Word{0xFF} << (8 * i);
  return table;
}

/// The runs of ones in `candidates` that have a bit of `seeds`, which are among them.
Word fillRuns(Word seeds, Word candidates)
{
  // A carry runs from a run's lowest seed to its end.
  Word filled = (((seeds + candidates) ^ candidates) | seeds) & candidates;
  Word path = candidates;
  for (int step = 1; step < kBits; step *= 2)
  {
    filled |= path & filled >> step;
    path &= path >> step;
  }
  return filled;
}

}  // namespace

void EdgeBits::reset(cv::Size size)
{
  if (size == size_) return;
  size_ = size;
  words_ = static_cast<std::size_t>((size.width + kBits - 1) / kBits);
  stride_ = words_ + 2;
  candidates_.assign(stride_ * static_cast<std::size_t>(size.height + 2), 0);
  edges_ = candidates_;
}

void EdgeBits::setRow(int y, const std::uint8_t* marks)
{
  Word* const candidates = &candidates_[at(y)];
  Word* const edges = &edges_[at(y)];
  for (std::size_t i = 0; i < words_; ++i)
  {
    Word candidate = 0;
    Word strong = 0;
    for (int shift = 0; shift < kBits; shift += 8, marks += 8)
    {
      const Word bytes = load(marks);
      candidate |= gather(bytes) << shift;
      strong |= gather(bytes >> 7) << shift;
    }
    candidates[i] = candidate;
    edges[i] = strong;
  }
}

/// Takes to a word what its neighbours and itself have; whether it has gained anything.
bool EdgeBits::spread(std::size_t word)
{
  const Word candidates = candidates_[word];
  const Word before = edges_[word];
  if (candidates == before) return false;
  Word near = before;
  for (const std::size_t i : {word - stride_, word, word + stride_})
    near |= edges_[i] | edges_[i] << 1 | edges_[i] >> 1 | edges_[i - 1] >> (kBits - 1) | edges_[i + 1] << (kBits - 1);
  near &= candidates;
  if (near == 0) return false;
  edges_[word] = fillRuns(near, candidates);
  return edges_[word] != before;
}

void EdgeBits::connect()
{
  for (int y = 0; y < size_.height; ++y)
  {
    const std::size_t begin = at(y);
    for (std::size_t i = begin; i < begin + words_; ++i)
      spread(i);
    for (std::size_t i = begin + words_; i-- > begin;)
      spread(i);
  }
  for (int y = size_.height; y-- > 0;)
    for (std::size_t i = at(y); i < at(y) + words_; ++i)
      if (spread(i)) gained_.push_back(i);
  spreadFromList();
}

void EdgeBits::spreadFromList()
{
  while (!gained_.empty())
  {
    const std::size_t word = gained_.back();
    gained_.pop_back();
    for (const std::size_t middle : {word - stride_, word, word + stride_})
      for (const std::size_t i : {middle - 1, middle, middle + 1})
        if (candidates_[i] != 0 && spread(i)) gained_.push_back(i);
  }
}

void EdgeBits::write(cv::Mat& edges) const
{
  static const std::array<Word, 256> bytes_of = makeBytes();
  edges.create(size_, CV_8UC1);
  for (int y = 0; y < size_.height; ++y)
  {
    const Word* const bits = &edges_[at(y)];
    std::uint8_t* const row = edges.ptr(y);
    int x = 0;
    for (; x + 8 <= size_.width; x += 8)
      std::memcpy(row + x, &bytes_of[bits[x / kBits] >> x % kBits & 0xFF], 8);
    for (; x < size_.width; ++x)
      row[x] = (bits[x / kBits] >> x % kBits & 1) != 0 ? 255 : 0;
  }
}

}  // namespace robot_vision
