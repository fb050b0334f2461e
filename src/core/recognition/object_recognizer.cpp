#include "robot_vision/recognition/object_recognizer.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "claimed_pixels.hpp"
#include "core/geometry/rigid_motion.hpp"
#include "model_trials.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

/// What is probable enough, before others have claimed its pixels.
struct Probable
{
  RecognizedObject object;
  PoseVerdict verdict;

  /// By which the best explanation comes first.
  double explains() const { return verdict.probability * verdict.evidence.pixels; }
};

}  // namespace

struct ObjectRecognizer::Impl
{
  Impl(const RecognizerParams& p, const RefinerParams& refining, const VerifierParams& verifying,
       const DepthErrorParams& errors)
    : params((validate(p), p)), trials(p, refining, verifying, errors)
  {
  }

  Recognition recognize(const RecognitionFrame& frame, const std::vector<PoseCandidate>& candidates)
  {
    require(frame.hasColors() || frame.hasDepth(), "the frame", "empty", "set");
    Recognition recognition;
    recognition.reports.resize(shapes.size());
    probable.clear();
    const std::vector<std::vector<PoseCandidate>> by_model = sorted(candidates);
    for (std::size_t model = 0; model < shapes.size(); ++model)
    {
      ModelReport& report = recognition.reports[model];
      report.model = static_cast<int>(model);
      note(by_model[model], report);
      tryModel(frame, by_model[model], report);
    }
    claim(frame.size(), recognition);
    return recognition;
  }

  /// The candidates of each model, the best first, as many as are looked at.
  std::vector<std::vector<PoseCandidate>> sorted(const std::vector<PoseCandidate>& candidates) const
  {
    std::vector<std::vector<PoseCandidate>> by_model(shapes.size());
    for (const PoseCandidate& candidate : candidates)
    {
      const auto model = static_cast<std::size_t>(candidate.model);
      require(candidate.model >= 0 && model < shapes.size(), "the model of a candidate", candidate.model,
              "one of those that were added, " + std::to_string(shapes.size()));
      requireRigid(candidate.pose, "the pose of a candidate");
      requireRange("the score of a candidate", candidate.score, 0.0, 1.0);
      by_model[model].push_back(candidate);
    }
    for (std::vector<PoseCandidate>& of_model : by_model)
      std::stable_sort(of_model.begin(), of_model.end(),
                       [](const PoseCandidate& a, const PoseCandidate& b) { return a.score > b.score; });
    return by_model;
  }

  void note(const std::vector<PoseCandidate>& candidates, ModelReport& report) const
  {
    report.candidates = static_cast<int>(candidates.size());
    if (candidates.empty()) return;
    report.best_score = candidates.front().score;
    const cv::Vec3d center = shapes[static_cast<std::size_t>(report.model)]->extent().center;
    report.nearest_distance = cv::norm(candidates.front().pose * center);
    for (const PoseCandidate& candidate : candidates)
      report.nearest_distance = std::min(report.nearest_distance, cv::norm(candidate.pose * center));
  }

  void tryModel(const RecognitionFrame& frame, std::vector<PoseCandidate> candidates, ModelReport& report)
  {
    candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(params.max_candidates)));
    const ObjectShape& shape = *shapes[static_cast<std::size_t>(report.model)];
    for (const Trial& trial : trials.run(frame, shape, candidates, report))
    {
      if (trial.verdict.probability < params.threshold) continue;
      RecognizedObject object;
      object.model = report.model;
      object.pose = trial.refined.pose;
      object.covariance = trial.refined.covariance;
      object.free_axes = trial.refined.free_axes;
      object.probability = trial.verdict.probability;
      object.occlusion = trial.verdict.occlusion;
      object.match_score = trial.match_score;
      object.box = trial.verdict.box;
      object.evidence = trial.verdict.evidence;
      probable.push_back({std::move(object), trial.verdict});
    }
  }

  /// Keeps of what is probable what explains pixels that nothing better does.
  void claim(const cv::Size& image, Recognition& recognition)
  {
    std::stable_sort(probable.begin(), probable.end(),
                     [](const Probable& a, const Probable& b) { return a.explains() > b.explains(); });
    claimed.begin(image);
    for (const Probable& each : probable)
    {
      ModelReport& report = recognition.reports[static_cast<std::size_t>(each.object.model)];
      if (claimed.unclaimed(each.verdict) < params.min_unclaimed)
      {
        report.reason = std::max(report.reason, MissReason::kClaimed);
        continue;
      }
      claimed.claim(each.verdict);
      ++report.found;
      recognition.objects.push_back(each.object);
    }
    for (ModelReport& report : recognition.reports)
      if (report.found > 0) report.reason = MissReason::kNone;
    std::stable_sort(recognition.objects.begin(), recognition.objects.end(),
                     [](const RecognizedObject& a, const RecognizedObject& b)
                     { return a.probability > b.probability; });
  }

  RecognizerParams params;
  ModelTrials trials;
  ClaimedPixels claimed;
  std::vector<std::shared_ptr<const ObjectShape>> shapes;
  std::vector<Probable> probable;
};

ObjectRecognizer::ObjectRecognizer(const RecognizerParams& params, const RefinerParams& refiner,
                                   const VerifierParams& verifier, const DepthErrorParams& errors)
  : impl_(std::make_unique<Impl>(params, refiner, verifier, errors))
{
}

ObjectRecognizer::~ObjectRecognizer() = default;

int ObjectRecognizer::add(std::shared_ptr<const ObjectShape> shape)
{
  require(shape != nullptr, "the shape of a model", "none", "an ObjectShape");
  impl_->shapes.push_back(std::move(shape));
  return static_cast<int>(impl_->shapes.size()) - 1;
}

Recognition ObjectRecognizer::recognize(const RecognitionFrame& frame, const std::vector<PoseCandidate>& candidates)
{
  return impl_->recognize(frame, candidates);
}

}  // namespace robot_vision
