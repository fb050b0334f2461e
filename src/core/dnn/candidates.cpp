#include "candidates.hpp"

#include <algorithm>
#include <cmath>

#include "score_kernels.hpp"

namespace robot_vision
{

Candidates::Candidates(const HeadParams& params)
  : thresholds_(params.class_thresholds.begin(), params.class_thresholds.end())
{
  if (thresholds_.empty()) thresholds_.push_back(static_cast<float>(params.score_threshold));
  lowest_ = *std::min_element(thresholds_.begin(), thresholds_.end());
  lowest_rank_ = rankOf(lowest_);
}

bool Candidates::reaches(float score, int class_id) const
{
  const std::size_t i = thresholds_.size() == 1 ? 0 : static_cast<std::size_t>(class_id);
  return std::isfinite(score) && score >= thresholds_[i];
}

void Candidates::add(float score, int class_id, std::size_t index, const CornerBox& box, double angle)
{
  const bool finite = std::isfinite(box.x0) && std::isfinite(box.y0) && std::isfinite(box.x1) && std::isfinite(box.y1);
  if (!finite || !std::isfinite(angle) || box.x1 <= box.x0 || box.y1 <= box.y0) return;
  found.push_back({score, class_id, index, box, angle});
}

void Candidates::addCentered(float score, int class_id, std::size_t index, double x, double y, double width,
                             double height, double angle)
{
  add(score, class_id, index, {x - width / 2, y - height / 2, x + width / 2, y + height / 2}, angle);
}

}  // namespace robot_vision
