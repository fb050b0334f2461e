#pragma once

#include <vector>

#include "region_samples.hpp"

namespace robot_vision
{

constexpr float kMaxLayerDepth = 1000.0F;  // m, the largest depth that counts

/// Depths that hang together, in m.
struct DepthLayer
{
  double nearest = 0.0;
  double farthest = 0.0;
  double share = 0.0;  // of the weights of all samples

  bool has(double depth) const { return depth >= nearest && depth < farthest; }
};

/// The nearest layer that has at least this share of the weights; without such a one that with most. `samples` must not
/// be empty.
DepthLayer nearestLayer(const std::vector<RegionSample>& samples, double min_share);

}  // namespace robot_vision
