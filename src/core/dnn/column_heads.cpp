#include <algorithm>
#include <cstddef>
#include <vector>

#include "heads.hpp"
#include "score_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr std::int64_t kAny = HeadOutputs::kAny;
constexpr std::size_t kBoxesAtOnce = 2048;  // their ranks and classes stay in the first cache

/// What is behind the scores of each box.
std::size_t extrasOf(const HeadParams& params, const HeadOutputs& outputs)
{
  if (params.task == "segment") return outputs.rows(1, {kAny, kAny, kAny}).rows;
  if (params.task == "pose") return static_cast<std::size_t>(params.keypoints * params.keypoint_values);
  return params.task == "oriented" ? 1 : 0;
}

}  // namespace

void findYolov8(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  outputs.requireCount(params.task == "segment" ? 2 : 1);
  const std::size_t extras = extrasOf(params, outputs);
  const std::int64_t values = 4 + params.classes + static_cast<std::int64_t>(extras);
  const OutputRows rows = outputs.rows(0, {values, kAny});
  const std::size_t boxes = rows.columns;
  candidates.extras = {rows.row(4 + static_cast<std::size_t>(params.classes)), 1, boxes, extras};
  const bool oriented = params.task == "oriented";

  const ScoreKernels& kernel = kernels<ScoreKernels>();
  std::vector<std::int32_t> ranks(std::min(boxes, kBoxesAtOnce)), classes(ranks.size());
  for (std::size_t begin = 0; begin < boxes; begin += kBoxesAtOnce)
  {
    const std::size_t count = std::min(kBoxesAtOnce, boxes - begin);
    std::fill(ranks.begin(), ranks.end(), kNoRank);
    for (int c = 0; c < params.classes; ++c)
      kernel.keep_best(rows.row(4 + static_cast<std::size_t>(c)) + begin, c, static_cast<int>(count), ranks.data(),
                       classes.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      if (ranks[i] < candidates.lowestRank()) continue;
      const float score = scoreOf(ranks[i]);
      if (!candidates.reaches(score, classes[i])) continue;
      const float* const box = rows.values + begin + i;
      candidates.addCentered(score, classes[i], begin + i, box[0], box[boxes], box[2 * boxes], box[3 * boxes],
                             oriented ? candidates.extras.at(begin + i, 0) : 0.0);
    }
  }
}

}  // namespace robot_vision
