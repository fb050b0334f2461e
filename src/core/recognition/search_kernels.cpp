#include "search_kernels.hpp"

#include "core/simd/kernel_numbers.hpp"
#include "core/simd/vectors.hpp"
#include "frame_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kFirstFeatures = kCodeFeatures / 2;
constexpr int kMostOfByte = 255;

/// Bins of the edges and surfaces that may be of an object there; where no depth is known, only those of the image.
ROBOT_VISION_INLINE std::uint32_t usable(std::uint32_t bins, std::uint32_t range, std::uint32_t least,
                                         std::uint32_t most)
{
  const bool there = ((range & 0xFFFF) >= least) & ((range >> 16) <= most);
  const std::uint32_t used = there ? bins : 0;
  return range == kNoRange ? bins & 0xFF : used;
}

template <bool kDepth>
void cellBins(const SearchedFrame& from, const PlaceLanes& lanes, float column, float row,
              std::uint32_t* __restrict bins)
{
  const SearchedFrame frame = from;
  const auto margin = static_cast<float>(frame.margin);
  for (int i = 0; i < kPlacesAtOnce; ++i)
  {
    const float x = lanes.x[i] + column * lanes.across_x[i] + row * lanes.along_x[i];
    const float y = lanes.y[i] + column * lanes.across_y[i] + row * lanes.along_y[i];
    const float inside_x = lesser(greater(x, -margin), frame.width),
                inside_y = lesser(greater(y, -margin), frame.height);
    const std::int32_t u = static_cast<std::int32_t>(inside_x + margin + 0.5F) - frame.margin;
    const std::int32_t v = static_cast<std::int32_t>(inside_y + margin + 0.5F) - frame.margin;
    const std::int32_t at = lanes.window[i] + v * frame.stride + u;
    bins[i] = kDepth ? usable(frame.bins[at], frame.ranges[at], lanes.least[i], lanes.most[i]) : frame.bins[at];
  }
}

void gather(const SearchedFrame& frame, const PlaceLanes& lanes, int column, int row, std::uint8_t* __restrict planes)
{
  constexpr int kKind = kCellBins / 2;  // number of the bins of edges of depth, after those of the image
  std::uint32_t bins[kPlacesAtOnce];
  const auto find = frame.ranges == nullptr ? cellBins<false> : cellBins<true>;
  const auto depth_edge_score = static_cast<std::uint32_t>(frame.ranges == nullptr ? kOnlyEdgeScore : kDepthEdgeScore);
  find(frame, lanes, static_cast<float>(column), static_cast<float>(row), bins);
  for (int k = 0; k < kKind; ++k)
  {
    std::uint8_t* __restrict const edges = planes + k * kPlacesAtOnce;
    std::uint8_t* __restrict const surfaces = edges + kKind * kPlacesAtOnce;
    for (int i = 0; i < kPlacesAtOnce; ++i)
    {
      const std::uint32_t edge = bins[i] >> k & 1, depth_edge = bins[i] >> (k + kKind) & 1;
      edges[i] = static_cast<std::uint8_t>(depth_edge * depth_edge_score + (edge & ~depth_edge) * kImageEdgeScore);
      surfaces[i] = static_cast<std::uint8_t>((bins[i] >> (k + 2 * kKind) & 1) * kSurfaceScore);
    }
  }
}

#ifdef ROBOT_VISION_VECTORS

constexpr int kVectors = kPlacesAtOnce / static_cast<int>(sizeof(Simd::Vector));

/// The sums of all places.
struct Sums
{
  Simd::Vector parts[kVectors];

  void add(const std::uint8_t* planes, const std::uint16_t* features, int count)
  {
    for (int f = 0; f < count; ++f)
    {
      const std::uint8_t* const plane = planes + kPlacesAtOnce * features[f];
      for (int i = 0; i < kVectors; ++i)
        parts[i] = Simd::addSaturated(parts[i], Simd::load(plane + i * sizeof(Simd::Vector)));
    }
  }

  Sums doubled() const
  {
    Sums twice;
    for (int i = 0; i < kVectors; ++i)
      twice.parts[i] = Simd::addSaturated(parts[i], parts[i]);
    return twice;
  }

  /// A bit for each place whose sum is above its floor.
  std::uint64_t above(const std::uint8_t* floors) const
  {
    std::uint64_t bits = 0;
    for (int i = 0; i < kVectors; ++i)
    {
      const Simd::Vector floor = Simd::load(floors + i * sizeof(Simd::Vector));
      const std::uint64_t part = Simd::nonzeroBytes(Simd::subtractSaturated(parts[i], floor));
      bits |= part << (i * static_cast<int>(sizeof(Simd::Vector)) & 63);
    }
    return bits;
  }
};

std::uint64_t above(const std::uint8_t* planes, const std::uint16_t* features, const std::uint8_t* floors,
                    std::uint8_t* scores)
{
  Sums sums;
  for (Simd::Vector& part : sums.parts)
    part = Simd::zeros();
  sums.add(planes, features, kFirstFeatures);
  const std::uint64_t likely = sums.doubled().above(floors);
  if (likely == 0) return 0;
  sums.add(planes, features + kFirstFeatures, kCodeFeatures - kFirstFeatures);
  const std::uint64_t bits = likely & sums.above(floors);
  if (bits == 0) return 0;
  for (int i = 0; i < kVectors; ++i)
    Simd::store(scores + i * sizeof(Simd::Vector), sums.parts[i]);
  return bits;
}

#else

void add(const std::uint8_t* planes, const std::uint16_t* features, int count, std::uint8_t* __restrict scores)
{
  for (int f = 0; f < count; ++f)
  {
    const std::uint8_t* const plane = planes + kPlacesAtOnce * features[f];
    for (int i = 0; i < kPlacesAtOnce; ++i)
      scores[i] = static_cast<std::uint8_t>(lesser(scores[i] + plane[i], kMostOfByte));
  }
}

std::uint64_t bitsAbove(const std::uint8_t* scores, const std::uint8_t* floors, int times)
{
  std::uint64_t bits = 0;
  for (int i = 0; i < kPlacesAtOnce; ++i)
    bits |= std::uint64_t{lesser(times * scores[i], kMostOfByte) > floors[i] ? 1U : 0U} << i;
  return bits;
}

std::uint64_t above(const std::uint8_t* planes, const std::uint16_t* features, const std::uint8_t* floors,
                    std::uint8_t* scores)
{
  for (int i = 0; i < kPlacesAtOnce; ++i)
    scores[i] = 0;
  add(planes, features, kFirstFeatures, scores);
  const std::uint64_t likely = bitsAbove(scores, floors, 2);
  if (likely == 0) return 0;
  add(planes, features + kFirstFeatures, kCodeFeatures - kFirstFeatures, scores);
  return likely & bitsAbove(scores, floors, 1);
}

#endif

}  // namespace

template <>
const SearchKernels KernelTable<SearchKernels, ROBOT_VISION_SET>::table = {gather, above};

}  // namespace robot_vision
