#include "hsv_kernels.hpp"

#include <cstdint>

#include "core/simd/pixel_vectors.hpp"
#include "hsv_tests.hpp"

namespace robot_vision
{
namespace
{

inline std::uint8_t larger(std::uint8_t a, std::uint8_t b)
{
  return a > b ? a : b;
}

template <class Number>
inline Number smaller(Number a, Number b)
{
  return a < b ? a : b;
}

// A loop of 8- and 16-bit integers without branches, which compilers vectorize.
void applyTestsInLoop(const HsvTests& tests, const std::uint8_t* __restrict pixels, int count,
                      std::uint8_t* __restrict mask)
{
  using Byte = std::uint8_t;
  using Short = std::int16_t;
  const HsvTests t = tests;  // a copy, which for the compiler cannot change by writes to `mask`
  for (int i = 0; i < count; ++i)
  {
    const Byte first = pixels[3 * i];
    const Byte second = pixels[3 * i + 1];
    const Byte third = pixels[3 * i + 2];
    const Byte max = larger(first, larger(second, third));
    const Byte diff = static_cast<Byte>(max - smaller(first, smaller(second, third)));
    const Byte v_inside = (max >= t.v_low ? 255 : 0) & (max <= t.v_high ? 255 : 0);

    const Short s_low = static_cast<Short>(t.s_low.diff * diff - t.s_low.value * max - t.s_low.offset);
    const Short s_above = static_cast<Short>(t.s_above.diff * diff - t.s_above.value * max - t.s_above.offset);
    const Short s = smaller(s_low, static_cast<Short>(~s_above));

    const Short x = static_cast<Short>(second - first);  // two differences are enough, because the factors add up to 0
    const Short y = static_cast<Short>(third - first);
    const Short h_low = static_cast<Short>(t.h_low.channels[1] * x + t.h_low.channels[2] * y - t.h_low.offset);
    const Short h_above = static_cast<Short>(t.h_above.channels[1] * x + t.h_above.channels[2] * y - t.h_above.offset);
    const Short h = static_cast<Short>(smaller(h_low, static_cast<Short>(~h_above)) ^ t.h_outside);
    const Short h_slack = static_cast<Short>(static_cast<std::uint16_t>(t.h_slack * diff + 255) >> 8);

    const Byte inside = (s >= t.s_slack ? 255 : 0) & (h >= h_slack ? 255 : 0);
    const Byte perhaps =
        (s >= static_cast<Short>(-t.s_slack) ? kUndecided : 0) & (h >= static_cast<Short>(-h_slack) ? kUndecided : 0);
    mask[i] = (inside | perhaps) & v_inside;
  }
}

#ifdef ROBOT_VISION_PIXELS

/// The same tests for as many pixels as a vector has bytes. A sum of two products in a margin is a single instruction
/// on pairs of bytes. Only margins near 0 need to be exact, so that they may then saturate to bytes.
class HsvVectors
{
public:
  explicit HsvVectors(const HsvTests& t)
    : v_low_(PixelSimd::bytes(t.v_low)),
      v_range_(PixelSimd::bytes(t.v_high - t.v_low)),
      s_low_{pairs(t.s_low.diff, -t.s_low.value), Simd::words(-t.s_low.offset)},
      s_above_{pairs(-t.s_above.diff, t.s_above.value), Simd::words(t.s_above.offset - 1)},
      s_sure_(PixelSimd::bytes(t.s_slack - 1)),
      s_unsure_(PixelSimd::bytes(-t.s_slack - 1)),
      h_low_(plane(t.h_low, 1, one(t) - t.h_low.offset)),
      h_above_(plane(t.h_above, -1, one(t) + t.h_above.offset - 1)),
      h_outside_(PixelSimd::bytes(t.h_outside)),
      h_slack_(pairs(t.h_slack, 0))
  {
  }

  void apply(const std::uint8_t* pixels, std::uint8_t* mask) const
  {
    const Planes p = loadPlanes(pixels);
    const Vector max = PixelSimd::maxBytes(p.first, PixelSimd::maxBytes(p.second, p.third));
    const Vector min = PixelSimd::minBytes(p.first, PixelSimd::minBytes(p.second, p.third));
    const Vector diff = PixelSimd::subtractBytes(max, min);
    const Halves saturation = halves(diff, max);
    const Vector s = packed(sLimit(saturation.low), sLimit(saturation.high));
    const Mask v_inside = PixelSimd::lessEqualUnsigned(PixelSimd::subtractBytes(max, v_low_), v_range_);
    const Mask s_perhaps = PixelSimd::both(v_inside, PixelSimd::greaterSigned(s, s_unsure_));
    if (!PixelSimd::any(s_perhaps))  // is true for most pixels, because objects are small
    {
      Simd::store(mask, Simd::zeros());
      return;
    }
    const Halves two = halves(p.first, p.second);
    const Halves third = halves(p.third, PixelSimd::bytes(1));
    const Vector h = PixelSimd::Xor(packed(hLimit(two.low, third.low), hLimit(two.high, third.high)), h_outside_);
    const Vector slack = packed(hSlack(saturation.low), hSlack(saturation.high));
    const Mask inside = PixelSimd::both(PixelSimd::greaterSigned(s, s_sure_), PixelSimd::greaterSigned(h, slack));
    const Mask h_perhaps = PixelSimd::greaterSigned(PixelSimd::addSignedSaturated(h, slack), Simd::zeros());
    const Vector sure = PixelSimd::bytesWhere(PixelSimd::both(v_inside, inside), PixelSimd::bytes(255));
    const Vector perhaps = PixelSimd::bytesWhere(PixelSimd::both(s_perhaps, h_perhaps), PixelSimd::bytes(kUndecided));
    Simd::store(mask, Simd::Or(sure, perhaps));
  }

private:
  using Vector = Simd::Vector;
  using Mask = PixelSimd::Mask;

  struct Halves
  {
    Vector low, high;
  };
  struct Line
  {
    Vector factors, offset;
  };
  struct Plane
  {
    Vector first_two, third_and_one;
  };

  static Vector pairs(int first, int second) { return Simd::words((first & 0xFF) | (second & 0xFF) << 8); }
  static Halves halves(Vector a, Vector b) { return {Simd::InterleaveLower(a, b), Simd::InterleaveUpper(a, b)}; }
  static Vector packed(Vector low, Vector high) { return PixelSimd::packSignedWords(low, high); }

  // 1 is added to margins of hue, so that "at least the slack" becomes "above the slack". If the range is outside of
  // the wedge, 1 is subtracted, because the margins are inverted afterwards.
  static int one(const HsvTests& tests) { return tests.h_outside != 0 ? -1 : 1; }
  static Plane plane(const HueLimit& limit, int sign, int offset)
  {
    const std::int16_t* const factors = limit.channels;
    return {pairs(sign * factors[0], sign * factors[1]), pairs(sign * factors[2], offset)};
  }

  Vector sLimit(Vector diff_and_max) const
  {
    return PixelSimd::minWords(Simd::addBytePairs(s_low_.offset, diff_and_max, s_low_.factors),
                               Simd::addBytePairs(s_above_.offset, diff_and_max, s_above_.factors));
  }

  static Vector hMargin(const Plane& limit, Vector first_two, Vector third_and_one)
  {
    const Vector sum = Simd::addBytePairs(Simd::zeros(), first_two, limit.first_two);
    return Simd::addBytePairs(sum, third_and_one, limit.third_and_one);
  }

  Vector hLimit(Vector first_two, Vector third_and_one) const
  {
    return PixelSimd::minWords(hMargin(h_low_, first_two, third_and_one), hMargin(h_above_, first_two, third_and_one));
  }

  Vector hSlack(Vector diff_and_max) const
  {
    return PixelSimd::upperBytes(Simd::addBytePairs(Simd::words(255), diff_and_max, h_slack_));
  }

  Vector v_low_;
  Vector v_range_;
  Line s_low_;
  Line s_above_;
  Vector s_sure_;
  Vector s_unsure_;
  Plane h_low_;
  Plane h_above_;
  Vector h_outside_;
  Vector h_slack_;
};

void applyTests(const HsvTests& tests, const std::uint8_t* pixels, int count, std::uint8_t* mask)
{
  constexpr int kPixels = static_cast<int>(sizeof(Simd::Vector));
  if (count < kPixels || tests.v_low > tests.v_high) return applyTestsInLoop(tests, pixels, count, mask);
  const HsvVectors vectors(tests);
  int i = 0;
  for (; i + kPixels <= count; i += kPixels)
    vectors.apply(pixels + 3 * i, mask + i);
  if (i < count) vectors.apply(pixels + 3 * (count - kPixels), mask + count - kPixels);
}

#else

constexpr auto applyTests = applyTestsInLoop;

#endif

}  // namespace

template <>
const HsvKernels KernelTable<HsvKernels, ROBOT_VISION_SET>::table = {
    applyTests,
};

}  // namespace robot_vision
