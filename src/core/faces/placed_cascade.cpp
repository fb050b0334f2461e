#include "placed_cascade.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr double kMaxVotes = 1 << 30;  // rounded votes of a stage

/// The factor by which votes are rounded to integers.
double votesPerUnit(const HaarStage& stage)
{
  double most = std::abs(stage.threshold);
  for (const HaarStump& stump : stage.stumps)
    most += std::max(std::abs(stump.below), std::abs(stump.above));
  return std::exp2(std::floor(std::log2(kMaxVotes / std::max(most, 1e-6))));
}

std::int32_t rounded(float vote, double unit)
{
  return static_cast<std::int32_t>(std::lround(static_cast<double>(vote) * unit));
}

}  // namespace

PlacedCascade::PlacedCascade(const HaarCascade& cascade, const HaarLayout& of) : layout(of)
{
  std::size_t count = 0;
  for (const HaarStage& stage : cascade.stages)
    count += stage.stumps.size();
  stumps.reserve(count);
  for (const HaarStage& stage : cascade.stages)
  {
    const double unit = votesPerUnit(stage);
    const PlacedStump* const first = stumps.data() + stumps.size();
    std::int32_t pairs = 0;
    for (const bool pair : {true, false})
      for (const HaarStump& stump : stage.stumps)
      {
        if ((stump.rectangles[2].weight == 0.0F) != pair) continue;
        place(stump, unit);
        pairs += pair ? 1 : 0;
      }
    const auto number = static_cast<std::int32_t>(stage.stumps.size());
    const std::int32_t threshold = rounded(stage.threshold, unit);
    const std::int32_t error = number + 1;  // more than half a vote for each stump, and for the threshold
    stages.push_back({first, pairs, number, threshold - error, threshold + error});
  }
}

void PlacedCascade::place(const HaarStump& stump, double unit)
{
  PlacedStump& to = stumps.emplace_back();
  for (std::size_t i = 0; i < stump.rectangles.size(); ++i)
  {
    const cv::Point begin = stump.rectangles[i].box.tl(), end = stump.rectangles[i].box.br();
    const HaarCorners corners = {layout.indexOf(begin.x, begin.y), layout.indexOf(end.x, begin.y),
                                 layout.indexOf(begin.x, end.y), layout.indexOf(end.x, end.y)};
    std::copy_n(corners, 4, to.corners[i]);
    to.weights[i] = stump.rectangles[i].weight;
  }
  to.threshold = stump.threshold;
  to.below = rounded(stump.below, unit);
  to.above = rounded(stump.above, unit);
}

}  // namespace robot_vision
