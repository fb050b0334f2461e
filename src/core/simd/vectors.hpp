#pragma once

#ifdef __SSE2__
#include <immintrin.h>
#endif

#include <cstdint>

namespace robot_vision
{
namespace  // unnamed, so that each instruction set has a copy of its own
{

// Operations that compilers do not find in loops by themselves, such as sums of products of neighbours and bit masks of
// bytes. Simd exists on x86 only, and its Vector is as wide as the instruction set allows. Unless a name says more, an
// operation works on each byte, word (16 bits) or integer (32 bits) by itself.

#if defined(__AVX512BW__)
#define ROBOT_VISION_VECTORS

struct Simd
{
  using Vector = __m512i;

  static Vector load(const void* from) { return _mm512_loadu_si512(from); }
  static void store(void* to, Vector v) { _mm512_storeu_si512(to, v); }
  static Vector zeros() { return _mm512_setzero_si512(); }
  static Vector bytes(int value) { return _mm512_set1_epi8(static_cast<char>(value)); }
  static Vector words(int value) { return _mm512_set1_epi16(static_cast<short>(value)); }
  static Vector integers(int value) { return _mm512_set1_epi32(value); }
  static Vector addSaturated(Vector a, Vector b) { return _mm512_adds_epu8(a, b); }  // unsigned bytes, 255 at most
  static Vector addIntegers(Vector a, Vector b) { return _mm512_add_epi32(a, b); }
  static Vector subtractSaturated(Vector a, Vector b) { return _mm512_subs_epu8(a, b); }  // unsigned bytes, 0 at least
  static Vector lesserBytes(Vector a, Vector b) { return _mm512_min_epu8(a, b); }         // unsigned
  static Vector greaterBytes(Vector a, Vector b) { return _mm512_max_epu8(a, b); }
  static Vector InterleaveLower(Vector a, Vector b) { return _mm512_unpacklo_epi8(a, b); }
  static Vector InterleaveUpper(Vector a, Vector b) { return _mm512_unpackhi_epi8(a, b); }
  static Vector InterleaveLowerWords(Vector a, Vector b) { return _mm512_unpacklo_epi16(a, b); }
  static Vector InterleaveUpperWords(Vector a, Vector b) { return _mm512_unpackhi_epi16(a, b); }
  /// The lower words of integers from 0 to 65535, in the order that InterleaveLowerWords() and InterleaveUpperWords()
  /// had words in to make these integers of.
  static Vector packIntegers(Vector lower, Vector upper) { return _mm512_packus_epi32(lower, upper); }
  static Vector Or(Vector a, Vector b) { return _mm512_or_si512(a, b); }
  static Vector Xor(Vector a, Vector b) { return _mm512_xor_si512(a, b); }
  static Vector And(Vector a, Vector b) { return _mm512_and_si512(a, b); }
  static Vector upperWords(Vector a) { return _mm512_srli_epi32(a, 16); }
  /// A mask with one bit for each byte, 1 where the byte is not 0. The first byte has the lowest bit.
  static std::uint64_t nonzeroBytes(Vector a) { return _mm512_test_epi8_mask(a, a); }
  /// The inverse: 255 in each byte whose bit is 1, else 0.
  static Vector bytesOfBits(std::uint64_t bits) { return _mm512_movm_epi8(bits); }
  /// Adds to each word of `sum` the products of two neighbouring bytes (unsigned) with their factors (signed bytes).
  static Vector addBytePairs(Vector sum, Vector bytes, Vector factors)
  {
    return _mm512_add_epi16(sum, _mm512_maddubs_epi16(bytes, factors));
  }
  /// Adds to each integer of `sum` the products of two neighbouring signed words.
  static Vector addWordPairs(Vector sum, Vector a, Vector b)
  {
#ifdef __AVX512VNNI__
    return _mm512_dpwssd_epi32(sum, a, b);
#else
    return addIntegers(sum, _mm512_madd_epi16(a, b));
#endif
  }
  /// Stores words in the order that the bytes had before InterleaveLower() and InterleaveUpper() made words of them.
  static void storeInOrder(std::uint16_t* to, Vector low, Vector high)
  {
    store(to, _mm512_permutex2var_epi64(low, _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), high));
    store(to + 32, _mm512_permutex2var_epi64(low, _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15), high));
  }
  /// Stores words from 0 to 255 as bytes.
  static void storeBytes(std::uint8_t* to, Vector first, Vector second)
  {
    const Vector packed = _mm512_packus_epi16(first, second);
    store(to, _mm512_permutexvar_epi64(_mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7), packed));
  }
};

#elif defined(__AVX2__)
#define ROBOT_VISION_VECTORS

struct Simd
{
  using Vector = __m256i;

  static Vector load(const void* from) { return _mm256_loadu_si256(static_cast<const Vector*>(from)); }
  static void store(void* to, Vector v) { _mm256_storeu_si256(static_cast<Vector*>(to), v); }
  static Vector zeros() { return _mm256_setzero_si256(); }
  static Vector bytes(int value) { return _mm256_set1_epi8(static_cast<char>(value)); }
  static Vector words(int value) { return _mm256_set1_epi16(static_cast<short>(value)); }
  static Vector integers(int value) { return _mm256_set1_epi32(value); }
  static Vector addSaturated(Vector a, Vector b) { return _mm256_adds_epu8(a, b); }
  static Vector addIntegers(Vector a, Vector b) { return _mm256_add_epi32(a, b); }
  static Vector subtractSaturated(Vector a, Vector b) { return _mm256_subs_epu8(a, b); }
  static Vector lesserBytes(Vector a, Vector b) { return _mm256_min_epu8(a, b); }
  static Vector greaterBytes(Vector a, Vector b) { return _mm256_max_epu8(a, b); }
  static Vector InterleaveLower(Vector a, Vector b) { return _mm256_unpacklo_epi8(a, b); }
  static Vector InterleaveUpper(Vector a, Vector b) { return _mm256_unpackhi_epi8(a, b); }
  static Vector InterleaveLowerWords(Vector a, Vector b) { return _mm256_unpacklo_epi16(a, b); }
  static Vector InterleaveUpperWords(Vector a, Vector b) { return _mm256_unpackhi_epi16(a, b); }
  static Vector packIntegers(Vector lower, Vector upper) { return _mm256_packus_epi32(lower, upper); }
  static Vector Or(Vector a, Vector b) { return _mm256_or_si256(a, b); }
  static Vector Xor(Vector a, Vector b) { return _mm256_xor_si256(a, b); }
  static Vector And(Vector a, Vector b) { return _mm256_and_si256(a, b); }
  static Vector upperWords(Vector a) { return _mm256_srli_epi32(a, 16); }
  static std::uint64_t nonzeroBytes(Vector a)
  {
    return ~static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(a, zeros())));
  }
  static Vector bytesOfBits(std::uint64_t bits)
  {
    const Vector places = _mm256_setr_epi64x(0, 0x0101010101010101, 0x0202020202020202, 0x0303030303030303);
    const Vector each = _mm256_set1_epi64x(static_cast<std::int64_t>(0x8040201008040201));
    const Vector all = _mm256_shuffle_epi8(integers(static_cast<int>(bits)), places);
    return _mm256_cmpeq_epi8(And(all, each), each);
  }
  static Vector addBytePairs(Vector sum, Vector bytes, Vector factors)
  {
    return _mm256_add_epi16(sum, _mm256_maddubs_epi16(bytes, factors));
  }
  static Vector addWordPairs(Vector sum, Vector a, Vector b) { return addIntegers(sum, _mm256_madd_epi16(a, b)); }
  static void storeInOrder(std::uint16_t* to, Vector low, Vector high)
  {
    store(to, _mm256_permute2x128_si256(low, high, 0x20));
    store(to + 16, _mm256_permute2x128_si256(low, high, 0x31));
  }
  static void storeBytes(std::uint8_t* to, Vector first, Vector second)
  {
    store(to, _mm256_permute4x64_epi64(_mm256_packus_epi16(first, second), 0xD8));
  }
};

#elif defined(__SSE4_1__)
#define ROBOT_VISION_VECTORS

struct Simd
{
  using Vector = __m128i;

  static Vector load(const void* from) { return _mm_loadu_si128(static_cast<const Vector*>(from)); }
  static void store(void* to, Vector v) { _mm_storeu_si128(static_cast<Vector*>(to), v); }
  static Vector zeros() { return _mm_setzero_si128(); }
  static Vector bytes(int value) { return _mm_set1_epi8(static_cast<char>(value)); }
  static Vector words(int value) { return _mm_set1_epi16(static_cast<short>(value)); }
  static Vector integers(int value) { return _mm_set1_epi32(value); }
  static Vector addSaturated(Vector a, Vector b) { return _mm_adds_epu8(a, b); }
  static Vector addIntegers(Vector a, Vector b) { return _mm_add_epi32(a, b); }
  static Vector subtractSaturated(Vector a, Vector b) { return _mm_subs_epu8(a, b); }
  static Vector lesserBytes(Vector a, Vector b) { return _mm_min_epu8(a, b); }
  static Vector greaterBytes(Vector a, Vector b) { return _mm_max_epu8(a, b); }
  static Vector InterleaveLower(Vector a, Vector b) { return _mm_unpacklo_epi8(a, b); }
  static Vector InterleaveUpper(Vector a, Vector b) { return _mm_unpackhi_epi8(a, b); }
  static Vector InterleaveLowerWords(Vector a, Vector b) { return _mm_unpacklo_epi16(a, b); }
  static Vector InterleaveUpperWords(Vector a, Vector b) { return _mm_unpackhi_epi16(a, b); }
  static Vector packIntegers(Vector lower, Vector upper) { return _mm_packus_epi32(lower, upper); }
  static Vector Or(Vector a, Vector b) { return _mm_or_si128(a, b); }
  static Vector Xor(Vector a, Vector b) { return _mm_xor_si128(a, b); }
  static Vector And(Vector a, Vector b) { return _mm_and_si128(a, b); }
  static Vector upperWords(Vector a) { return _mm_srli_epi32(a, 16); }
  static std::uint64_t nonzeroBytes(Vector a)
  {
    return ~static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(a, zeros()))) & 0xFFFF;
  }
  static Vector bytesOfBits(std::uint64_t bits)
  {
    const Vector places = _mm_set_epi64x(0x0101010101010101, 0);
    const Vector each = _mm_set1_epi64x(static_cast<std::int64_t>(0x8040201008040201));
    const Vector all = _mm_shuffle_epi8(words(static_cast<int>(bits)), places);
    return _mm_cmpeq_epi8(And(all, each), each);
  }
  static Vector addBytePairs(Vector sum, Vector bytes, Vector factors)
  {
    return _mm_add_epi16(sum, _mm_maddubs_epi16(bytes, factors));
  }
  static Vector addWordPairs(Vector sum, Vector a, Vector b) { return addIntegers(sum, _mm_madd_epi16(a, b)); }
  static void storeInOrder(std::uint16_t* to, Vector low, Vector high)
  {
    store(to, low);
    store(to + 8, high);
  }
  static void storeBytes(std::uint8_t* to, Vector first, Vector second) { store(to, _mm_packus_epi16(first, second)); }
};

#endif

}  // namespace
}  // namespace robot_vision
