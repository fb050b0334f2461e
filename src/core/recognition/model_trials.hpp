#pragma once

#include <optional>
#include <vector>

#include "hypotheses.hpp"
#include "robot_vision/recognition/object_recognizer.hpp"

namespace robot_vision
{

/// A pose that was refined and verified.
struct Trial
{
  RefinedPose refined;
  PoseVerdict verdict;
  double match_score = 0.0;  // of its candidate
  double rank = 0.0;         // of its hypothesis
};

/// Refines and verifies what is most promising of a model, not much more than once at each place.
class ModelTrials
{
public:
  ModelTrials(const RecognizerParams& params, const RefinerParams& refiner, const VerifierParams& verifier,
              const DepthErrorParams& errors);

  /// The best pose at each place, of those candidates that come first; notes in the report what became of them. Of
  /// poses at a place one is right at most: that counts, too, of how much of what is seen there it is the explanation.
  /// Valid until the next call.
  const std::vector<Trial>& run(const RecognitionFrame& frame, const ObjectShape& shape,
                                const std::vector<PoseCandidate>& candidates, ModelReport& report);

private:
  /// Where an object may be, and what was tried there.
  struct Place
  {
    cv::Vec3d center;  // m
    int tried = 0;
    std::optional<Trial> best;
  };

  const std::vector<Hypothesis>& promising(const RecognitionFrame& frame, const ObjectShape& shape,
                                           const std::vector<PoseCandidate>& candidates, ModelReport& report);
  void preferWhatExplainsMost(const MeshExtent& extent);
  bool isBetter(const PoseVerdict& verdict, const PoseVerdict& than) const;
  int triedInVain() const;
  Place& placeOf(const Hypothesis& hypothesis, const MeshExtent& extent);
  bool isDecided(const Place& place, const Hypothesis& other, const ObjectShape& shape) const;
  Trial tryPose(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose, double match_score,
                ModelReport& report);
  void tryLookAlikes(const RecognitionFrame& frame, const ObjectShape& shape, Trial& best, ModelReport& report);

  RecognizerParams params_;
  PoseRefiner refiner_;
  PoseVerifier verifier_;
  PoseVerifier quick_verifier_;  // which looks at few pixels
  Hypotheses hypotheses_;
  std::vector<Hypothesis> promising_;
  std::vector<Place> places_;
  std::vector<Trial> best_;
};

}  // namespace robot_vision
