#include "model_trials.hpp"

#include <algorithm>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr double kPlace = 0.4;        // of the diameter: hypotheses that are nearer are at one place
constexpr double kMinLogOdds = -3.0;  // of a pose whose look-alikes are tried
constexpr int kQuickPixels = 500;     // that are looked at first
constexpr double kMinQuick = -2.0;    // log odds by these, before a pose is refined
constexpr double kMaxGain = 4.0;      // by which they may become larger when it is

VerifierParams withFewPixels(VerifierParams params)
{
  params.max_pixels = std::min(params.max_pixels, kQuickPixels);
  return params;
}

/// A pose of an object after it was turned about its own center.
cv::Affine3d turned(const cv::Affine3d& pose, const cv::Matx33d& turn, const cv::Vec3d& center)
{
  const cv::Matx33d rotation = pose.rotation() * turn;
  return {rotation, pose * center - rotation * center};
}

}  // namespace

ModelTrials::ModelTrials(const RecognizerParams& params, const RefinerParams& refiner, const VerifierParams& verifier,
                         const DepthErrorParams& errors)
  : params_((validate(params), params)),
    refiner_(refiner, errors),
    verifier_(verifier, errors),
    quick_verifier_(withFewPixels(verifier), errors),
    hypotheses_(errors, refiner.search)
{
}

const std::vector<Trial>& ModelTrials::run(const RecognitionFrame& frame, const ObjectShape& shape,
                                           const std::vector<PoseCandidate>& candidates, ModelReport& report)
{
  places_.clear();
  best_.clear();
  for (const Hypothesis& hypothesis : promising(frame, shape, candidates, report))
  {
    if (report.refined >= params_.max_refined) break;
    Place& place = placeOf(hypothesis, shape.extent());
    if (place.tried >= params_.max_per_place || isDecided(place, hypothesis)) continue;
    ++place.tried;
    ++report.refined;
    Trial trial = tryPose(frame, shape, hypothesis.pose, hypothesis.score, report);
    if (!place.best || trial.verdict.log_odds > place.best->verdict.log_odds) place.best = std::move(trial);
  }
  for (Place& place : places_)
  {
    if (!place.best) continue;
    tryLookAlikes(frame, shape, *place.best, report);
    best_.push_back(std::move(*place.best));
  }
  return best_;
}

/// The hypotheses that are worth to be refined, the best first.
const std::vector<Hypothesis>& ModelTrials::promising(const RecognitionFrame& frame, const ObjectShape& shape,
                                                      const std::vector<PoseCandidate>& candidates, ModelReport& report)
{
  promising_ = hypotheses_.select(frame, shape, candidates, report);
  if (!frame.hasDepth()) return promising_;  // contours are not where they should be before a pose is refined
  for (Hypothesis& hypothesis : promising_)
    hypothesis.quality = quick_verifier_.verify(frame, shape, hypothesis.pose).log_odds;
  const auto end = std::remove_if(promising_.begin(), promising_.end(),
                                  [](const Hypothesis& hypothesis) { return hypothesis.quality < kMinQuick; });
  if (end != promising_.end()) report.reason = std::max(report.reason, MissReason::kNotThere);
  promising_.erase(end, promising_.end());
  std::stable_sort(promising_.begin(), promising_.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.quality > b.quality; });
  return promising_;
}

/// Whether a pose is sure, or so much better than another one seems to be that this need not be tried.
bool ModelTrials::isDecided(const Place& place, const Hypothesis& other) const
{
  if (!place.best) return false;
  return place.best->verdict.probability >= params_.sure || place.best->verdict.log_odds > other.quality + kMaxGain;
}

ModelTrials::Place& ModelTrials::placeOf(const Hypothesis& hypothesis, const MeshExtent& extent)
{
  for (Place& place : places_)
    if (cv::norm(place.center - hypothesis.center) < kPlace * extent.diameter) return place;
  places_.push_back({hypothesis.center, 0, std::nullopt});
  return places_.back();
}

Trial ModelTrials::tryPose(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose,
                           double match_score, ModelReport& report)
{
  Trial trial;
  trial.refined = refiner_.refine(frame, shape, pose);
  trial.verdict = verifier_.verify(frame, shape, trial.refined.pose);
  trial.match_score = match_score;
  report.best_probability = std::max(report.best_probability, trial.verdict.probability);
  report.reason = std::max(report.reason, MissReason::kImprobable);
  return trial;
}

/// Surfaces, which most of what finds poses goes by, do not tell some rotations from others, but colors do.
void ModelTrials::tryLookAlikes(const RecognitionFrame& frame, const ObjectShape& shape, Trial& best,
                                ModelReport& report)
{
  if (!frame.hasColors() || best.verdict.log_odds < kMinLogOdds) return;
  const cv::Affine3d pose = best.refined.pose;
  double most = best.verdict.log_odds;
  const cv::Matx33d* better = nullptr;
  for (const cv::Matx33d& turn : shape.lookAlikes())
  {
    const double log_odds = verifier_.verify(frame, shape, turned(pose, turn, shape.extent().center)).log_odds;
    if (log_odds <= most) continue;
    most = log_odds;
    better = &turn;
  }
  if (better == nullptr) return;
  Trial other = tryPose(frame, shape, turned(pose, *better, shape.extent().center), best.match_score, report);
  if (other.verdict.log_odds > best.verdict.log_odds) best = std::move(other);
}

}  // namespace robot_vision
