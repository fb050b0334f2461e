#include "hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rigid_motion.hpp"
#include "rendered_region.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinPixels = 60;        // px^2, of the box around an object
constexpr double kMinKnown = 0.1;     // share of an object's points with a depth
constexpr double kMinQuality = 0.25;  // of what few points say
constexpr double kSameShift = 0.08;   // of the diameter: what is nearer and turned less is the same hypothesis
constexpr double kSameTurn = 0.15;    // rad

}  // namespace

const std::vector<Hypothesis>& Hypotheses::select(const RecognitionFrame& frame, const ObjectShape& shape,
                                                  const std::vector<PoseCandidate>& candidates, ModelReport& report)
{
  found_.clear();
  different_.clear();
  for (const PoseCandidate& candidate : candidates)
    look(frame, shape, candidate, report);
  std::stable_sort(found_.begin(), found_.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.quality > b.quality; });
  for (const Hypothesis& hypothesis : found_)
    if (isNew(hypothesis, shape.extent())) different_.push_back(hypothesis);
  return different_;
}

void Hypotheses::look(const RecognitionFrame& frame, const ObjectShape& shape, const PoseCandidate& candidate,
                      ModelReport& report)
{
  const auto refuse = [&report](MissReason reason) { report.reason = std::max(report.reason, reason); };
  const cv::Rect box = projectedBox(shape.extent(), candidate.pose, frame.camera().K, frame.size());
  if (box.empty()) return refuse(MissReason::kOutside);
  if (box.area() < kMinPixels) return refuse(MissReason::kTooSmall);
  Hypothesis hypothesis;
  hypothesis.first = hypothesis.pose = candidate.pose;
  hypothesis.center = candidate.pose * shape.extent().center;
  hypothesis.quality = hypothesis.score = candidate.score;
  if (frame.hasDepth())
  {
    const CoarseFit fit = coarse_.check(frame, shape, candidate.pose);
    if (fit.known < kMinKnown) return refuse(MissReason::kNoDepth);
    if (fit.quality < kMinQuality) return refuse(MissReason::kNotThere);
    hypothesis.pose = fit.pose;
    hypothesis.is_moved = fit.is_moved;
    hypothesis.center = fit.pose * shape.extent().center;
    hypothesis.quality = fit.quality + candidate.score;
  }
  hypothesis.rank = hypothesis.quality;
  found_.push_back(hypothesis);
}

bool Hypotheses::isNew(const Hypothesis& hypothesis, const MeshExtent& extent) const
{
  return std::none_of(different_.begin(), different_.end(),
                      [&](const Hypothesis& other)
                      {
                        const cv::Vec6d way = difference(other.pose, hypothesis.pose);
                        return cv::norm(other.center - hypothesis.center) < kSameShift * extent.diameter &&
                               cv::norm(way.get_minor<3, 1>(3, 0)) < kSameTurn;
                      });
}

}  // namespace robot_vision
