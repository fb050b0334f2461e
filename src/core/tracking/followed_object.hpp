#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/features/flow_image.hpp"
#include "core/features/object_features.hpp"
#include "object_model.hpp"
#include "robot_vision/tracking/object_tracker.hpp"

namespace robot_vision
{

constexpr double kMinInterval = 1e-3;  // s, in which a velocity can be measured

/// Two frames, one after the other, and what is needed to follow something from one to the next.
struct FramePair
{
  /// Whether a velocity can be measured in that time.
  bool measurable() const { return passed >= kMinInterval; }

  FlowImage last, newest;
  double passed = 0.0;  // s from one to the other; 0 if they cannot be compared
  FlowParams flow;
};

/// One object of an ObjectTracker: what it looks like, and where it was seen last.
class FollowedObject
{
public:
  /// In a region of a gray picture (CV_8UC1), lost at first. Throws std::invalid_argument as ObjectModel does.
  FollowedObject(int id, const std::string& label, const cv::Mat& gray, const cv::Rect& region, int points);

  const TrackedObject& state() const { return state_; }
  const Features& features() const { return features_; }
  const Similarity& pose() const { return pose_; }
  /// Where it was when it was selected.
  const Similarity& firstPose() const { return model_.firstPose(); }
  /// Its outline, were it there.
  std::vector<cv::Point2f> outlineAt(const Similarity& pose) const { return pose(model_.corners()); }

  /// It is where it was in the picture that it was selected in.
  void markSeen();

  /// It was not seen in the last frame, or that cannot be compared with the newest.
  void lose();

  /// Follows it from the last frame to the newest. If that fails it is not there, but may be found in the same frame.
  void follow(FramePair& frames, const ObjectTrackerParams& params);

  /// How it would look where it is searched for.
  ModelFit fitAt(const Similarity& pose, FramePair& frames, double min_similarity) const;

  /// It is there if that share of its points is seen; whether it is. `smoothing` as in the parameters.
  bool accept(const ModelFit& fit, double min_confidence, const FramePair& frames, double smoothing);

private:
  struct Motion
  {
    cv::Point2d center, velocity;
  };

  void hide();
  cv::Point2d velocityFrom(const Motion& last, double passed, double smoothing) const;
  Similarity startOf(FramePair& frames) const;
  void describe();

  ObjectModel model_;
  Features features_;
  Similarity pose_;
  std::vector<std::size_t> seen_;  // the model's points that were in the last frame
  std::optional<Motion> last_;     // in the last frame, if it was seen there
  TrackedObject state_;
};

}  // namespace robot_vision
