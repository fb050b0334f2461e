#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "place_search.hpp"
#include "robot_vision/recognition/pose_candidate.hpp"
#include "robot_vision/recognition/symmetry.hpp"
#include "robot_vision/recognition/view_model.hpp"
#include "view_fit.hpp"
#include "view_search.hpp"
#include "view_templates.hpp"

namespace robot_vision
{

/// A model as a matcher needs it.
class MatchedModel
{
public:
  explicit MatchedModel(const ViewModel& model);

  const ViewModel& model() const { return model_; }
  const SymmetryGroup& symmetries() const { return symmetries_; }

  /// m, that of the cells around a place: one of a series, so that objects of about one size share them.
  double halfWidth() const { return half_width_; }

  /// Made when they are needed first.
  const ViewTemplates& templates(bool with_depth);

  const ViewFeatures& features(int view) const { return features_[static_cast<std::size_t>(view)]; }
  const cv::Matx33d& rotation(int view) const { return rotations_[static_cast<std::size_t>(view)]; }
  const View& view(int view) const { return model_.views[static_cast<std::size_t>(view)]; }

  std::size_t memory() const;

private:
  ViewModel model_;
  SymmetryGroup symmetries_;
  double half_width_;
  std::vector<ViewFeatures> features_;
  std::vector<cv::Matx33d> rotations_;
  std::unique_ptr<ViewTemplates> with_depth_, without_depth_;
};

/// A view at a pose.
struct Guess
{
  ViewPose pose;
  int view = 0;
  float score = 0.0F;
  cv::Matx33d rotation;  // of the object, and where its middle is (m)
  cv::Vec3d middle;
};

struct FitStage;

/// Makes candidates of what a ViewSearch has found of a model: the best by closer looks, one for each pose.
class CandidateSearch
{
public:
  CandidateSearch(const MatchedModel& model, const ViewTemplates& templates, const ObservedFrame& frame,
                  const ViewCamera& camera);

  /// The best `count`. Sorts the hits, and drops those that are too many.
  std::vector<PoseCandidate> find(const std::vector<Place>& places, std::vector<ViewHit>& hits, int count);

private:
  void keepBest(const std::vector<Place>& places, std::vector<ViewHit>& hits) const;
  void look(const ViewHit& hit, const Place& place, Guess& guess) const;
  void locate(Guess& guess) const;
  std::vector<Guess> bestOf(std::vector<Guess> guesses, std::size_t count, double distance, double angle) const;
  std::vector<Guess> improved(std::vector<Guess> guesses, std::size_t count);
  void improve(const FitStage& stage, Guess& guess);

  const MatchedModel& model_;
  const ViewTemplates& templates_;
  const ObservedFrame& frame_;
  const ViewCamera& camera_;
  ViewFit fit_;
};

}  // namespace robot_vision
