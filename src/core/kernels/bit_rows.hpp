#pragma once

#include <cstdint>
#include <cstring>

#include "kernels.hpp"
#include "vectors.hpp"

namespace robot_vision
{
namespace  // one for each instruction set
{

using BitWord = std::uint64_t;

constexpr int kBits = 64;

#ifdef ROBOT_VISION_VECTORS

constexpr int kVectors = kBits / static_cast<int>(sizeof(Simd::Vector));  // whose bytes are a word's bits

/// Which of kBits bytes are not 0, where `bytes` makes vectors of them.
template <class Bytes>
BitWord gather(const Bytes& bytes)
{
  BitWord word = 0;
  for (int i = 0; i < kVectors; ++i)
    word |= Simd::nonzeroBytes(bytes(i)) << (i * kBits / kVectors % kBits);
  return word;
}

inline BitWord differences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold)
{
  const Simd::Vector limit = Simd::bytes(threshold);
  const auto above = [=](int i)
  {
    const Simd::Vector first = Simd::load(a + i * kBits / kVectors);
    const Simd::Vector second = Simd::load(b + i * kBits / kVectors);
    const Simd::Vector difference = Simd::eitherBits(Simd::lowerBytes(first, second), Simd::lowerBytes(second, first));
    return Simd::lowerBytes(difference, limit);
  };
  return gather(above);
}

inline BitWord commonWith(std::uint8_t bit, const std::uint8_t* bytes)
{
  return gather([=](int i) { return Simd::commonBits(Simd::load(bytes + i * kBits / kVectors), Simd::bytes(bit)); });
}

inline void spreadWord(BitWord word, std::uint8_t* bytes)
{
  for (int i = 0; i < kVectors; ++i)
    Simd::store(bytes + i * kBits / kVectors, Simd::bytesOfBits(word >> (i * kBits / kVectors % kBits)));
}

#else

/// Which of kBits bytes have the lowest bit: of each eight, the first one lowest, it is multiplied to its place in the
/// highest byte. Bytes are in the order of their addresses from the lowest (as on all that ROS runs on).
inline BitWord gather(const std::uint8_t* bytes)
{
  BitWord word = 0;
  for (int i = 0; i < kBits; i += 8)
  {
    BitWord eight;
    std::memcpy(&eight, bytes + i, sizeof eight);
    word |= ((eight & 0x0101010101010101U) * 0x0102040810204080U >> 56) << i;
  }
  return word;
}

inline BitWord differences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold)
{
  std::uint8_t above[kBits];
  for (int i = 0; i < kBits; ++i)
  {
    const std::uint8_t larger = a[i] > b[i] ? a[i] : b[i];
    const std::uint8_t smaller = a[i] > b[i] ? b[i] : a[i];
    above[i] = static_cast<std::uint8_t>(larger - smaller) > threshold ? 1 : 0;
  }
  return gather(above);
}

inline BitWord commonWith(std::uint8_t bit, const std::uint8_t* bytes)
{
  std::uint8_t common[kBits];
  for (int i = 0; i < kBits; ++i)
    common[i] = (bytes[i] & bit) != 0 ? 1 : 0;
  return gather(common);
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
  for (int i = 0; i < kBits; i += 8)
    std::memcpy(bytes + i, &kBytes.of[word >> i & 0xFF], 8);
}

#endif

void markDifferences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold, int count, BitWord* bits)
{
  for (; count >= kBits; count -= kBits, a += kBits, b += kBits)
    *bits++ = differences(a, b, threshold);
  if (count == 0) return;
  std::uint8_t rest_of_a[kBits] = {};
  std::uint8_t rest_of_b[kBits] = {};
  std::memcpy(rest_of_a, a, static_cast<std::size_t>(count));
  std::memcpy(rest_of_b, b, static_cast<std::size_t>(count));
  *bits = differences(rest_of_a, rest_of_b, threshold);
}

void splitMarks(const std::uint8_t* marks, int words, BitWord* candidates, BitWord* strong)
{
  for (int i = 0; i < words; ++i, marks += kBits)
  {
    candidates[i] = commonWith(kCandidate, marks);
    strong[i] = commonWith(kStrong, marks);
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
    const BitWord later = bits[i] << places | bits[i - 1] >> (kBits - places);
    const BitWord earlier = bits[i] >> places | bits[i + 1] << (kBits - places);
    united[i] = bits[i] | later | earlier;
  }
}

void spreadBits(const BitWord* bits, int count, std::uint8_t* bytes)
{
  for (; count >= kBits; count -= kBits, bytes += kBits)
    spreadWord(*bits++, bytes);
  if (count == 0) return;
  std::uint8_t rest[kBits];
  spreadWord(*bits, rest);
  std::memcpy(bytes, rest, static_cast<std::size_t>(count));
}

}  // namespace
}  // namespace robot_vision
