#include "model_trials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr double kPlace = 0.4;        // of the diameter: hypotheses that are nearer are at one place
constexpr double kMinLogOdds = -3.0;  // of a pose whose look-alikes are tried
constexpr int kQuickPixels = 500;     // that are looked at first
constexpr double kMinQuick = -5.0;    // log odds by these, before a pose is refined
constexpr double kOfMatch = 0.5;      // share of the log odds of its score that is added to these for its rank
constexpr double kMaxGain = 4.0;      // by which the log odds of a pose that is refined may be above its rank
constexpr double kMaxLoss = 1.5;      // of rank, by which another pose than one that is sure may be worse
constexpr double kOther = 0.35;       // rad, by which such a pose is turned
// What the logarithm of the pixels that a pose explains adds to its log odds, when it is refined and before: some
// pixels more are chance then.
constexpr double kExplained = 60.0, kQuickExplained = 20.0;

VerifierParams withFewPixels(VerifierParams params)
{
  params.max_pixels = std::min(params.max_pixels, kQuickPixels);
  return params;
}

/// What a pose explains of what is seen at a place is the more in favor of it, the less others there explain. What one
/// of them calls hidden, while another one finds the object's surface there, speaks against it, though something may
/// well hide an object: the handle of a mug is behind what is before the mug, or it is the one that is seen.
double explained(double pixels, double weight)
{
  return weight * std::log(std::max(pixels, 1.0));
}

double logOdds(double probability)
{
  constexpr double kSure = 0.999;
  const double p = std::clamp(probability, 1.0 - kSure, kSure);
  return std::log(p / (1.0 - p));
}

double preference(const PoseVerdict& verdict)
{
  return verdict.log_odds + explained(verdict.evidence.pixels, kExplained);
}

bool isSamePlace(const cv::Vec3d& a, const cv::Vec3d& b, const MeshExtent& extent)
{
  return cv::norm(a - b) < kPlace * extent.diameter;
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
    // Without depths all trials count: places before and behind an object look like it, too.
    if ((frame.hasDepth() ? triedInVain() : report.refined) >= params_.max_refined) break;
    Place& place = placeOf(hypothesis, shape.extent());
    if (place.tried >= params_.max_per_place || isDecided(place, hypothesis, shape)) continue;
    ++place.tried;
    ++report.refined;
    Trial trial = tryPose(frame, shape, hypothesis.pose, hypothesis.score, report);
    trial.rank = hypothesis.rank;
    if (!place.best || isBetter(trial.verdict, place.best->verdict)) place.best = std::move(trial);
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
  {
    PoseVerdict verdict = quick_verifier_.verify(frame, shape, hypothesis.first);
    if (hypothesis.is_moved)
    {
      const PoseVerdict moved = quick_verifier_.verify(frame, shape, hypothesis.pose);
      // What has moved it goes by a few depths, which noise can draw aside.
      if (verdict.log_odds > moved.log_odds) hypothesis.pose = hypothesis.first;
      verdict.log_odds = std::max(verdict.log_odds, moved.log_odds);
      verdict.evidence.pixels = std::max(verdict.evidence.pixels, moved.evidence.pixels);
    }
    hypothesis.quality = verdict.log_odds;
    hypothesis.rank = verdict.log_odds + kOfMatch * logOdds(hypothesis.score);
    hypothesis.pixels = verdict.evidence.pixels;
  }
  const auto end = std::remove_if(promising_.begin(), promising_.end(),
                                  [](const Hypothesis& hypothesis) { return hypothesis.quality < kMinQuick; });
  if (end != promising_.end()) report.reason = std::max(report.reason, MissReason::kNotThere);
  promising_.erase(end, promising_.end());
  preferWhatExplainsMost(shape.extent());
  std::stable_sort(promising_.begin(), promising_.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.rank > b.rank; });
  return promising_;
}

/// Lowers the rank of hypotheses that explain less than others at their place.
void ModelTrials::preferWhatExplainsMost(const MeshExtent& extent)
{
  std::vector<double> most;
  for (const Hypothesis& hypothesis : promising_)
  {
    double pixels = 0.0;
    for (const Hypothesis& other : promising_)
      if (isSamePlace(hypothesis.center, other.center, extent)) pixels = std::max(pixels, other.pixels);
    most.push_back(pixels);
  }
  for (std::size_t i = 0; i < promising_.size(); ++i)
    promising_[i].rank += explained(promising_[i].pixels, kQuickExplained) - explained(most[i], kQuickExplained);
}

/// Whether another pose need not be tried: it seems to be so much worse than the best one, or that one is sure and the
/// other is no other way to explain what is seen.
bool ModelTrials::isDecided(const Place& place, const Hypothesis& other, const ObjectShape& shape) const
{
  if (!place.best) return false;
  const PoseVerdict& best = place.best->verdict;
  if (best.log_odds > other.rank + kMaxGain) return true;
  if (best.probability < params_.sure) return false;
  return place.best->rank > other.rank + kMaxLoss ||
         shape.symmetries().angle(place.best->refined.pose.rotation(), other.pose.rotation()) < kOther;
}

/// Of two poses at a place; none that is too improbable is better than one that is not.
bool ModelTrials::isBetter(const PoseVerdict& verdict, const PoseVerdict& than) const
{
  if ((verdict.probability < params_.threshold) != (than.probability < params_.threshold))
    return verdict.probability > than.probability;
  return preference(verdict) > preference(than);
}

/// How many poses were tried where there is nothing that is probable enough.
int ModelTrials::triedInVain() const
{
  int tried = 0;
  for (const Place& place : places_)
    if (place.best->verdict.probability < params_.threshold) tried += place.tried;
  return tried;
}

ModelTrials::Place& ModelTrials::placeOf(const Hypothesis& hypothesis, const MeshExtent& extent)
{
  for (Place& place : places_)
    if (isSamePlace(place.center, hypothesis.center, extent)) return place;
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
  PoseVerdict most = best.verdict;
  const cv::Matx33d* better = nullptr;
  for (const cv::Matx33d& turn : shape.lookAlikes())
  {
    PoseVerdict verdict = verifier_.verify(frame, shape, turned(pose, turn, shape.extent().center));
    if (!isBetter(verdict, most)) continue;
    most = std::move(verdict);
    better = &turn;
  }
  if (better == nullptr) return;
  Trial other = tryPose(frame, shape, turned(pose, *better, shape.extent().center), best.match_score, report);
  if (isBetter(other.verdict, best.verdict)) best = std::move(other);
}

}  // namespace robot_vision
