#include "view_fit.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd/kernel_tables.hpp"
#include "feature_bins.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kEdgeWindow = 2;    // of kWindows: 3 px
constexpr float kImageEdgeWeight = 0.6F;  // of an edge that is none of depth
constexpr int kMaxFeatures = 256;         // of one kind

/// Bit of the bin of the direction across an edge.
std::uint32_t edgeBit(float x, float y)
{
  constexpr float kTangents[3] = {0.41421356F, 1.0F, 2.41421356F};
  const float ax = std::abs(x), ay = std::abs(y);
  int bin = 0;
  for (const float tangent : kTangents)
    bin += ay >= tangent * ax ? 1 : 0;
  return 1U << ((x < 0.0F) != (y < 0.0F) ? 7 - bin : bin);
}

/// The smallest window that reaches so far (px) from its middle to both sides.
std::size_t windowAround(int reach)
{
  std::size_t i = 0;
  while (i + 1 < kWindows.size() && kWindows[i] < 2 * reach + 1)
    ++i;
  return i;
}

}  // namespace

/// A feature at its place in the frame.
struct ViewFit::Seen
{
  cv::Vec3f place;  // m, in the camera's optical frame
  cv::Vec3f normal;
  float inverse;    // 1/m
  float tolerance;  // 1/m
  int x, y;         // px
};

float FitCounts::evidence(const FitWeights& weights) const
{
  const float edges = 1.0F / static_cast<float>(std::max(1, all_edges));
  const float faces = 1.0F / static_cast<float>(std::max(1, all_surfaces));
  return weights.bias +
         edges * (weights.depth_edges * static_cast<float>(depth_edges) +
                  weights.image_edges * static_cast<float>(image_edges) +
                  weights.edges_beyond * static_cast<float>(edges_beyond) +
                  weights.hidden_edges * static_cast<float>(hidden_edges)) +
         faces * (weights.surfaces * static_cast<float>(surfaces) +
                  weights.surfaces_beyond * static_cast<float>(surfaces_beyond) +
                  weights.hidden_surfaces * static_cast<float>(hidden_surfaces));
}

ViewFit::ViewFit(const ObservedFrame& frame, const ViewCamera& camera)
  : frame_(frame),
    camera_(camera),
    fit_camera_{static_cast<float>(camera.fx()),        static_cast<float>(camera.fy()),
                static_cast<float>(camera.cx()),        static_cast<float>(camera.cy()),
                static_cast<float>(frame.size().width), static_cast<float>(frame.size().height)},
    numbers_(7 * kMaxFeatures),
    pixels_(2 * kMaxFeatures)
{
  float* const n = numbers_.data();
  seen_ = {n,
           n + kMaxFeatures,
           n + 2 * kMaxFeatures,
           n + 3 * kMaxFeatures,
           n + 4 * kMaxFeatures,
           n + 5 * kMaxFeatures,
           n + 6 * kMaxFeatures,
           pixels_.data(),
           pixels_.data() + kMaxFeatures};
}

int ViewFit::project(const ViewPoints& points, const ViewPose& pose, int most)
{
  FitPose exact;
  for (int i = 0; i < 9; ++i)
    exact.rotation[i] = static_cast<float>(pose.rotation.val[i]);
  for (int i = 0; i < 3; ++i)
    exact.anchor[i] = static_cast<float>(pose.anchor[i]);
  const int count = std::min({points.count(), most, kMaxFeatures});
  kernels<FitKernels>().project(points.points(), count, exact, fit_camera_, seen_);
  return count;
}

ViewFit::Seen ViewFit::seenAt(int i, const FitLimits& limits) const
{
  const float inverse = seen_.inverse[i];
  return {{seen_.x[i], seen_.y[i], seen_.z[i]},
          {seen_.nx[i], seen_.ny[i], seen_.nz[i]},
          inverse,
          static_cast<float>(limits.tolerance) * inverse * inverse + static_cast<float>(limits.growth),
          seen_.u[i],
          seen_.v[i]};
}

FitCounts ViewFit::count(const ViewFeatures& features, const ViewPose& pose, const FitLimits& limits)
{
  FitCounts counts;
  const auto countEdges = [&](const ViewPoints& points)
  {
    const int edges = project(points, pose, limits.most);
    counts.all_edges += edges;
    for (int i = 0; i < edges; ++i)
      if (seen_.u[i] < 0)
        ++counts.hidden_edges;
      else
        countEdge(seenAt(i, limits), counts);
  };
  countEdges(features.contours);
  if (!frame_.hasDepth())
  {
    countEdges(features.inner);
    return counts;
  }
  counts.all_surfaces = project(features.surfaces, pose, limits.most);
  for (int i = 0; i < counts.all_surfaces; ++i)
    if (seen_.u[i] < 0)
      ++counts.hidden_surfaces;
    else
      countSurface(seenAt(i, limits), limits.normal_cosine, counts);
  return counts;
}

void ViewFit::countEdge(const Seen& seen, FitCounts& counts) const
{
  const int x = seen.x - 1, y = seen.y - 1;
  const std::uint32_t bins = frame_.bins(kEdgeWindow)[y][x], bit = edgeBit(seen.normal[0], seen.normal[1]);
  if (frame_.hasDepth())
  {
    const float expected = seen.inverse * ObservedFrame::kInverseSteps;
    const float tolerance = seen.tolerance * ObservedFrame::kInverseSteps;
    const std::uint32_t range = frame_.ranges(kEdgeWindow)[y][x];
    if (static_cast<float>(farthestOf(range)) > expected + tolerance)
    {
      ++counts.hidden_edges;
      return;
    }
    if (static_cast<float>(nearestOf(range)) < expected - tolerance)
    {
      ++counts.edges_beyond;
      return;
    }
  }
  if ((bins >> kBins & bit) != 0 && (!frame_.hasDepth() || hasEdge(seen, bit << kBins)))
    ++counts.depth_edges;
  else if ((bins & bit) != 0)
    ++counts.image_edges;
}

/// Whether a pixel beside the feature, as far away as it is, has the bit: not one of what hides something there.
bool ViewFit::hasEdge(const Seen& seen, std::uint32_t bit) const
{
  for (int y = seen.y - 1; y <= seen.y + 1; ++y)
    for (int x = seen.x - 1; x <= seen.x + 1; ++x)
      if ((frame_.bins(0)[y][x] & bit) != 0 && std::abs(frame_.inverses()[y][x] - seen.inverse) <= seen.tolerance)
        return true;
  return false;
}

void ViewFit::countSurface(const Seen& seen, float cosine, FitCounts& counts) const
{
  const float inverse = frame_.inverses()[seen.y][seen.x];
  if (inverse == 0.0F || inverse > seen.inverse + seen.tolerance)
  {
    ++counts.hidden_surfaces;
    return;
  }
  if (inverse < seen.inverse - seen.tolerance)
  {
    ++counts.surfaces_beyond;
    return;
  }
  if (frame_.bins(0)[seen.y][seen.x] >> 2 * kBins == 0) return;
  const float a = frame_.across()[seen.y][seen.x], b = frame_.along()[seen.y][seen.x];
  const float c = inverse - camera_.rayX()[seen.x] * a - camera_.rayY(seen.y) * b;
  const float along = -(seen.normal[0] * a + seen.normal[1] * b + seen.normal[2] * c);
  if (along > 0.0F && along * along > cosine * cosine * (a * a + b * b + c * c)) ++counts.surfaces;
}

bool ViewFit::improve(const ViewFeatures& features, const FitLimits& limits, ViewPose& pose)
{
  PoseStep step;
  if (frame_.hasDepth())
  {
    const int surfaces = project(features.surfaces, pose, limits.most);
    for (int i = 0; i < surfaces; ++i)
      if (seen_.u[i] >= 0) addSurface(seenAt(i, limits), pose.anchor, limits.normal_cosine, step);
  }
  const int edges = project(features.contours, pose, limits.most);
  for (int i = 0; i < edges; ++i)
    if (seen_.u[i] >= 0) addEdge(seenAt(i, limits), pose.anchor, limits.reach, step);
  return step.apply(pose);
}

void ViewFit::addSurface(const Seen& seen, const cv::Vec3d& anchor, float cosine, PoseStep& step) const
{
  const float inverse = frame_.inverses()[seen.y][seen.x];
  if (std::abs(inverse - seen.inverse) > seen.tolerance || frame_.bins(0)[seen.y][seen.x] >> 2 * kBins == 0) return;
  const double a = frame_.across()[seen.y][seen.x], b = frame_.along()[seen.y][seen.x];
  const double rx = camera_.rayX()[seen.x], ry = camera_.rayY(seen.y), c = inverse - rx * a - ry * b;
  const cv::Vec3d normal = cv::Vec3d(a, b, c) * (-1.0 / std::sqrt(a * a + b * b + c * c));
  if (normal.dot(seen.normal) < cosine) return;
  const cv::Vec3d observed = cv::Vec3d(rx, ry, 1.0) * (1.0 / inverse), place = seen.place;
  step.add(place - anchor, normal, normal.dot(observed - place), 1.0);
}

/// Looks along the direction across an edge for the nearest one, of depth if there is one.
void ViewFit::addEdge(const Seen& seen, const cv::Vec3d& anchor, int reach, PoseStep& step) const
{
  const float length = std::sqrt(seen.normal[0] * seen.normal[0] + seen.normal[1] * seen.normal[1]);
  if (length < 0.1F) return;
  const float dx = seen.normal[0] / length, dy = seen.normal[1] / length;
  const std::uint32_t bit = edgeBit(dx, dy), either = bit << kBins | bit;
  const std::size_t window = windowAround(reach);
  const int half = (kWindows[window] - 1) / 2;
  if ((frame_.bins(window)[seen.y - half][seen.x - half] & either) == 0) return;
  int image_edge = reach + 1, found = reach + 1;
  for (int i = 0; i <= 2 * reach && found > reach; ++i)
  {
    const int at = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
    const int x = seen.x + cvRound(at * dx), y = seen.y + cvRound(at * dy);
    const std::uint32_t bins = frame_.bins(0)[y][x];
    if ((bins & either) == 0) continue;
    if (frame_.hasDepth() && std::abs(frame_.inverses()[y][x] - seen.inverse) > seen.tolerance) continue;
    if ((bins >> kBins & bit) != 0)
      found = at;
    else if (image_edge > reach)
      image_edge = at;
  }
  const bool only_image = found > reach;
  if (only_image && image_edge > reach) return;
  const double metres = 1.0 / (camera_.focalLength() * static_cast<double>(seen.inverse));
  // Along the image the point moves by its shift, less what the change of its depth moves it.
  const cv::Vec3d place = seen.place;
  const cv::Vec3d direction(dx, dy, -(dx * place[0] + dy * place[1]) / place[2]);
  step.add(place - anchor, direction, (only_image ? image_edge : found) * metres, only_image ? kImageEdgeWeight : 1.0);
}

}  // namespace robot_vision
