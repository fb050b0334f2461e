#include "edge_kernels.hpp"

#include <cstdint>

#include "core/image/bit_kernels.hpp"

namespace robot_vision
{
namespace
{

inline std::int16_t absolute(std::int16_t value)
{
  return static_cast<std::int16_t>(value < 0 ? -value : value);
}

inline void setMagnitude(std::int16_t dx, std::int16_t dy, std::int16_t& magnitude)
{
  magnitude = static_cast<std::int16_t>(absolute(dx) + absolute(dy));
}

inline void setMagnitude(std::int16_t dx, std::int16_t dy, std::int32_t& magnitude)
{
  magnitude = dx * dx + dy * dy;
}

template <class Magnitude>
void gradient(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int count,
              std::int16_t* __restrict dx, std::int16_t* __restrict dy, Magnitude* __restrict magnitude)
{
  for (int i = 0; i < count; ++i)
  {
    const auto x = static_cast<std::int16_t>((above[i + 1] - above[i - 1]) + 2 * (row[i + 1] - row[i - 1]) +
                                             (below[i + 1] - below[i - 1]));
    const auto y = static_cast<std::int16_t>((below[i - 1] - above[i - 1]) + 2 * (below[i] - above[i]) +
                                             (below[i + 1] - above[i + 1]));
    dx[i] = x;
    dy[i] = y;
    setMagnitude(x, y, magnitude[i]);
  }
}

template <class Magnitude>
void suppress(const Gradients<Magnitude>& gradients, const EdgeThresholds& thresholds, int count,
              std::uint8_t* __restrict marks)
{
  constexpr std::uint16_t kTan22 = 13573;    // tan(22.5 degrees) * 2^15, as cv::Canny has it
  const Gradients<Magnitude> g = gradients;  // a copy, which for the compiler cannot change by writes to `marks`
  const auto low = static_cast<Magnitude>(thresholds.low);
  const auto high = static_cast<Magnitude>(thresholds.high);
  for (int i = 0; i < count; ++i)
  {
    const std::int16_t dx = g.dx[i];
    const std::int16_t dy = g.dy[i];
    const auto x = static_cast<std::uint16_t>(absolute(dx));
    const auto y = static_cast<std::uint16_t>(absolute(dy));
    // These are the tests 2^15 * y < kTan22 * x and 2^15 * y > (kTan22 + 2^16) * x in 16 bits. They differ from those
    // of cv::Canny only for y == x == 0, where there is no candidate anyway.
    const auto x_tan = static_cast<std::uint16_t>(std::uint32_t{static_cast<std::uint16_t>(2 * x)} * kTan22 >> 16);
    const bool flat = y <= x_tan;
    const bool steep = y > static_cast<std::uint16_t>(x_tan + 2 * x);
    const bool falling = static_cast<std::int16_t>(dx ^ dy) >= 0;  // the gradient goes right and down, or left and up

    // All neighbours are loaded, because loading only those that are needed would take branches.
    const Magnitude above_left = g.above[i - 1];
    const Magnitude above = g.above[i];
    const Magnitude above_right = g.above[i + 1];
    const Magnitude left = g.row[i - 1];
    const Magnitude right = g.row[i + 1];
    const Magnitude below_left = g.below[i - 1];
    const Magnitude below = g.below[i];
    const Magnitude below_right = g.below[i + 1];
    const Magnitude diagonal_before = falling ? above_left : above_right;
    const Magnitude diagonal_after = falling ? below_right : below_left;
    // Along rows and columns a maximum may equal its second neighbour, that is, it must exceed one less.
    const Magnitude slanted_before = steep ? above : diagonal_before;
    const Magnitude slanted_after = steep ? static_cast<Magnitude>(below - 1) : diagonal_after;
    const Magnitude before = flat ? left : slanted_before;
    const Magnitude after = flat ? static_cast<Magnitude>(right - 1) : slanted_after;

    const Magnitude m = g.row[i];
    const Magnitude larger = before > after ? before : after;
    const Magnitude limit = larger > low ? larger : low;
    const auto strong = static_cast<std::uint8_t>(m > high ? kCandidate | kStrong : kCandidate);
    marks[i] = m > limit ? strong : 0;
  }
}

}  // namespace

template <>
const EdgeKernels<std::int16_t> KernelTable<EdgeKernels<std::int16_t>, ROBOT_VISION_SET>::table = {gradient, suppress};

template <>
const EdgeKernels<std::int32_t> KernelTable<EdgeKernels<std::int32_t>, ROBOT_VISION_SET>::table = {gradient, suppress};

}  // namespace robot_vision
