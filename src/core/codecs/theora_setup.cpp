#include "theora_setup.hpp"

#include <algorithm>
#include <array>

namespace robot_vision
{
namespace
{

constexpr std::array<std::uint8_t, 7> kMagic = {0x82, 't', 'h', 'e', 'o', 'r', 'a'};
constexpr int kQualities = 64;     // quality indices, each with two scales and a limit of the loop filter
constexpr int kCoefficients = 64;  // of a block
constexpr int kPlanes = 3;
constexpr int kHuffmanTables = 80;
constexpr int kMaxTokens = 32;      // leaves of a Huffman table
constexpr int kMaxCodeLength = 32;  // bits
constexpr int kTokenBits = 5;

/// Reads numbers from a packet, the highest bit first. Reads zeros after the packet's end.
class BitReader
{
public:
  BitReader(const std::vector<std::uint8_t>& bytes, std::size_t first_byte) : bytes_(bytes), next_(8 * first_byte) {}

  int read(int bits)
  {
    int number = 0;
    for (int i = 0; i < bits; ++i, ++next_)
      number = 2 * number + (ended() ? 0 : bytes_[next_ / 8] >> (7 - next_ % 8) & 1);
    return number;
  }
  void skip(int bits) { next_ += static_cast<std::size_t>(bits); }
  bool ended() const { return next_ >= 8 * bytes_.size(); }
  bool overrun() const { return next_ > 8 * bytes_.size(); }

private:
  const std::vector<std::uint8_t>& bytes_;
  std::size_t next_;  // bit
};

/// The number of bits that `number` needs.
int bitsOf(int number)
{
  int bits = 0;
  for (; number > 0; number /= 2)
    ++bits;
  return bits;
}

/// Reads the indices of the base matrices of consecutive ranges of quality. Returns false if they are not valid.
bool readRanges(BitReader& reader, int matrices)
{
  const int index_bits = bitsOf(matrices - 1);
  int quality = 0;
  bool known = reader.read(index_bits) < matrices;
  while (quality < kQualities - 1)
  {
    quality += reader.read(bitsOf(kQualities - 2 - quality)) + 1;
    known = reader.read(index_bits) < matrices && known;
  }
  return known && quality == kQualities - 1;
}

bool readQuantization(BitReader& reader)
{
  reader.skip(kQualities * reader.read(3));  // limits of the loop filter
  for (int i = 0; i < 2; ++i)                // scales of AC and of DC coefficients
    reader.skip(kQualities * (reader.read(4) + 1));
  const int matrices = reader.read(9) + 1;
  reader.skip(8 * kCoefficients * matrices);
  for (int plane = 0; plane < 2 * kPlanes; ++plane)  // those of key frames, then those of other frames
  {
    const bool repeats = plane > 0 && reader.read(1) == 0;
    if (!repeats && !readRanges(reader, matrices)) return false;
    if (repeats && plane >= kPlanes) reader.skip(1);  // says which plane is repeated
  }
  return true;
}

/// Reads a binary tree, depth first: 0 begins two branches, 1 a leaf. Returns false if it is not valid.
bool readHuffmanTable(BitReader& reader)
{
  int tokens = 0;
  std::array<bool, kMaxCodeLength> second{};  // whether the second branch is being read, on each level above
  int depth = 0;
  while (!reader.ended())
  {
    if (reader.read(1) == 0)
    {
      if (depth == kMaxCodeLength) return false;
      second[depth++] = false;
      continue;
    }
    if (++tokens > kMaxTokens) return false;
    reader.skip(kTokenBits);
    while (depth > 0 && second[depth - 1])
      --depth;
    if (depth == 0) return true;
    second[depth - 1] = true;
  }
  return false;
}

}  // namespace

bool isTheoraSetup(const std::vector<std::uint8_t>& packet)
{
  if (packet.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), packet.begin())) return false;
  BitReader reader(packet, kMagic.size());
  if (!readQuantization(reader)) return false;
  for (int i = 0; i < kHuffmanTables; ++i)
    if (!readHuffmanTable(reader)) return false;
  return !reader.overrun();
}

}  // namespace robot_vision
