#include "look_kernels.hpp"

#include "core/simd/kernel_numbers.hpp"
#include "search_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kHalf = kCodeFeatures / 2;  // of a code, with half of the contours before half of the surfaces
constexpr int kHalfContours = kCodeContours / 2;
constexpr int kEdgeBins = kCellBins / 2;
constexpr float kNearest = 0.02F;  // m, in front of the camera

/// What a feature meets in the frame.
struct Met
{
  std::uint32_t bins;
  std::int32_t hidden, beyond;
};

template <bool kDepth>
ROBOT_VISION_INLINE Met meet(const LookFrame& frame, const LookPose& pose, float x, float y, float z)
{
  const float* const r = pose.rotation;
  const float u = r[0] * x + r[1] * y + r[2] * z + pose.anchor[0];
  const float v = r[3] * x + r[4] * y + r[5] * z + pose.anchor[1];
  const float w = r[6] * x + r[7] * y + r[8] * z + pose.anchor[2];
  const float inverse = 1.0F / greater(w, kNearest);
  const auto margin = static_cast<float>(frame.margin);
  const float across = lesser(greater(u * inverse * frame.fx + frame.cx, -margin), frame.width);
  const float down = lesser(greater(v * inverse * frame.fy + frame.cy, -margin), frame.height);
  const std::int32_t column = static_cast<std::int32_t>(across + margin + 0.5F) - frame.margin;
  const std::int32_t row = static_cast<std::int32_t>(down + margin + 0.5F) - frame.margin;
  const std::int32_t at = row * frame.stride + column;
  if (!kDepth) return {frame.bins[at], 0, 0};
  const std::uint32_t range = frame.ranges[at];
  const float expected = inverse * frame.inverse_steps, tolerance = frame.tolerance * inverse * expected;
  const auto nearest = static_cast<float>(static_cast<std::int32_t>(range & 0xFFFF));
  const auto farthest = static_cast<float>(static_cast<std::int32_t>(range >> 16));
  const bool hidden = farthest > expected + tolerance, beyond = nearest < expected - tolerance;
  return {frame.bins[at], hidden ? 1 : 0, !hidden & beyond ? 1 : 0};
}

template <bool kDepth>
void look(const LookFrame& from, const LookPoints& points, const LookPose& at, const std::uint16_t* features,
          LookCounts& counts)
{
  const LookFrame frame = from;
  const LookPose pose = at;
  std::int32_t depth_edges = 0, image_edges = 0, hidden_edges = 0, edges_beyond = 0;
  std::int32_t surfaces = 0, hidden_surfaces = 0, surfaces_beyond = 0;
  for (int half = 0; half < 2; ++half)
  {
    const float *const x = points.x + half * kHalf, *const y = points.y + half * kHalf,
                       *const z = points.z + half * kHalf;
    const std::uint16_t* const code = features + half * kHalf;
    for (int i = 0; i < kHalfContours; ++i)
    {
      const Met met = meet<kDepth>(frame, pose, x[i], y[i], z[i]);
      const std::uint32_t bin = code[i] % kCellBins;
      const std::int32_t seen = 1 - met.hidden - met.beyond;
      const auto depth_edge = static_cast<std::int32_t>(met.bins >> (bin + kEdgeBins) & 1) & seen;
      depth_edges += depth_edge;
      image_edges += static_cast<std::int32_t>(met.bins >> bin & 1) & seen & ~depth_edge;
      hidden_edges += met.hidden;
      edges_beyond += met.beyond;
    }
    for (int i = kHalfContours; i < kHalf; ++i)
    {
      const Met met = meet<kDepth>(frame, pose, x[i], y[i], z[i]);
      const std::uint32_t bin = code[i] % kCellBins;
      // Without surfaces there are other features of their place, whose bin is one of edges.
      const std::int32_t seen = 1 - met.hidden - met.beyond;
      const std::uint32_t shift = bin + kEdgeBins;
      surfaces += static_cast<std::int32_t>(met.bins >> shift & 1) & seen;
      hidden_surfaces += met.hidden;
      surfaces_beyond += met.beyond;
    }
  }
  counts = {depth_edges, image_edges, hidden_edges, edges_beyond, surfaces, hidden_surfaces, surfaces_beyond};
}

}  // namespace

template <>
const LookKernels KernelTable<LookKernels, ROBOT_VISION_SET>::table = {look<true>, look<false>};

}  // namespace robot_vision
