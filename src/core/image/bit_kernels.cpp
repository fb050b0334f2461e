#include "bit_kernels.hpp"

#include <cstdint>
#include <cstring>

#include "core/simd/vectors.hpp"

namespace robot_vision
{
namespace
{

#ifdef ROBOT_VISION_VECTORS

constexpr int kVectors = kWordBits / static_cast<int>(sizeof(Simd::Vector));  // with a byte for each bit of a word

/// A word whose bits are 1 where bytes are not 0; `bytes(i)` is the i-th of kVectors vectors of them.
template <class Bytes>
BitWord gather(const Bytes& bytes)
{
  BitWord word = 0;
  for (int i = 0; i < kVectors; ++i)
    word |= Simd::nonzeroBytes(bytes(i)) << (i * kWordBits / kVectors % kWordBits);
  return word;
}

inline BitWord differences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold)
{
  const Simd::Vector limit = Simd::bytes(threshold);
  const auto above = [=](int i)
  {
    const Simd::Vector first = Simd::load(a + i * kWordBits / kVectors);
    const Simd::Vector second = Simd::load(b + i * kWordBits / kVectors);
    const Simd::Vector difference =
        Simd::Or(Simd::subtractSaturated(first, second), Simd::subtractSaturated(second, first));
    return Simd::subtractSaturated(difference, limit);
  };
  return gather(above);
}

/// Which of kWordBits bytes have this bit.
inline BitWord bytesWith(std::uint8_t bit, const std::uint8_t* bytes)
{
  return gather([=](int i) { return Simd::And(Simd::load(bytes + i * kWordBits / kVectors), Simd::bytes(bit)); });
}

inline void spreadWord(BitWord word, std::uint8_t* bytes)
{
  for (int i = 0; i < kVectors; ++i)
    Simd::store(bytes + i * kWordBits / kVectors, Simd::bytesOfBits(word >> (i * kWordBits / kVectors % kWordBits)));
}

#else

/// Which of kWordBits bytes have the lowest bit. Eight bytes at a time, a multiplication shifts the bit of the i-th
/// byte to bit i of the highest byte. This needs a little-endian machine, which all machines that run ROS are.
inline BitWord gather(const std::uint8_t* bytes)
{
  BitWord word = 0;
  for (int i = 0; i < kWordBits; i += 8)
  {
    BitWord eight;
    std::memcpy(&eight, bytes + i, sizeof eight);
    word |= ((eight & 0x0101010101010101U) * 0x0102040810204080U >> 56) << i;
  }
  return word;
}

inline BitWord differences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold)
{
  std::uint8_t above[kWordBits];
  for (int i = 0; i < kWordBits; ++i)
  {
    const std::uint8_t larger = a[i] > b[i] ? a[i] : b[i];
    const std::uint8_t smaller = a[i] > b[i] ? b[i] : a[i];
    above[i] = static_cast<std::uint8_t>(larger - smaller) > threshold ? 1 : 0;
  }
  return gather(above);
}

inline BitWord bytesWith(std::uint8_t bit, const std::uint8_t* bytes)
{
  std::uint8_t has_bit[kWordBits];
  for (int i = 0; i < kWordBits; ++i)
    has_bit[i] = (bytes[i] & bit) != 0 ? 1 : 0;
  return gather(has_bit);
}

struct BytesOfBits
{
  constexpr BytesOfBits()
  {
    for (unsigned bits = 0; bits < 256; ++bits)
      for (unsigned i = 0; i < 8; ++i)
        if ((bits >> i & 1) != 0) of[bits] |= BitWord{0xFF} << (8 * i);
  }

  BitWord of[256] = {};
};

inline void spreadWord(BitWord word, std::uint8_t* bytes)
{
  static constexpr BytesOfBits kBytes;
  for (int i = 0; i < kWordBits; i += 8)
    std::memcpy(bytes + i, &kBytes.of[word >> i & 0xFF], 8);
}

#endif

void markDifferences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold, int count, BitWord* bits)
{
  for (; count >= kWordBits; count -= kWordBits, a += kWordBits, b += kWordBits)
    *bits++ = differences(a, b, threshold);
  if (count == 0) return;
  std::uint8_t rest_of_a[kWordBits] = {};
  std::uint8_t rest_of_b[kWordBits] = {};
  std::memcpy(rest_of_a, a, static_cast<std::size_t>(count));
  std::memcpy(rest_of_b, b, static_cast<std::size_t>(count));
  *bits = differences(rest_of_a, rest_of_b, threshold);
}

void splitMarks(const std::uint8_t* marks, int words, BitWord* candidates, BitWord* strong)
{
  for (int i = 0; i < words; ++i, marks += kWordBits)
  {
    candidates[i] = bytesWith(kCandidate, marks);
    strong[i] = bytesWith(kStrong, marks);
  }
}

void unite(const BitWord* const* rows, int number, int words, BitWord* __restrict united)
{
  for (int i = 0; i < words; ++i)
    united[i] = rows[0][i];
  for (int j = 1; j < number; ++j)
    for (int i = 0; i < words; ++i)
      united[i] |= rows[j][i];
}

void uniteNeighbours(const BitWord* bits, int words, int places, BitWord* __restrict united)
{
  for (int i = 0; i < words; ++i)
  {
    const BitWord later = bits[i] << places | bits[i - 1] >> (kWordBits - places);
    const BitWord earlier = bits[i] >> places | bits[i + 1] << (kWordBits - places);
    united[i] = bits[i] | later | earlier;
  }
}

void spreadBits(const BitWord* bits, int count, std::uint8_t* bytes)
{
  for (; count >= kWordBits; count -= kWordBits, bytes += kWordBits)
    spreadWord(*bits++, bytes);
  if (count == 0) return;
  std::uint8_t rest[kWordBits];
  spreadWord(*bits, rest);
  std::memcpy(bytes, rest, static_cast<std::size_t>(count));
}

}  // namespace

template <>
const BitKernels KernelTable<BitKernels, ROBOT_VISION_SET>::table = {
    markDifferences, splitMarks, unite, uniteNeighbours, spreadBits,
};

}  // namespace robot_vision
