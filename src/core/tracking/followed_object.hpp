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

/// The last two frames, between which objects are followed.
struct FramePair
{
  FlowImage last, newest;
  double elapsed = 0.0;  // s between them; 0 if they cannot be compared
  FlowParams flow;
};

/// One object of an ObjectTracker: its appearance, and where it was seen last.
class FollowedObject
{
public:
  /// Makes an object of a region of a gray image (CV_8UC1); it counts as lost at first. Throws std::invalid_argument as
  /// ObjectModel does.
  FollowedObject(int id, const std::string& label, const cv::Mat& gray, const cv::Rect& region, int points);

  const TrackedObject& state() const { return state_; }
  const Features& features() const { return features_; }
  const Similarity& pose() const { return pose_; }
  /// The pose that it was selected in.
  const Similarity& firstPose() const { return model_.firstPose(); }
  /// The outline that it has in a pose.
  std::vector<cv::Point2f> outlineAt(const Similarity& pose) const { return pose(model_.corners()); }

  /// The last round of SearchRounds in which it was searched for; 0: none.
  int searchRound() const { return search_round_; }
  void setSearchRound(int round) { search_round_ = round; }

  /// Makes it tracked in the pose that it was selected in.
  void setSeen();

  /// Makes it lost, because it was not seen in the last frame or that cannot be compared with the newest.
  void setLost();

  /// Follows it from the last frame to the newest. If that fails it is lost, but may be found in the same frame.
  void follow(FramePair& frames, const ObjectTrackerParams& params);

  /// Fits the model to the newest frame, beginning with a pose.
  ModelFit fitAt(const Similarity& pose, FramePair& frames, double min_similarity) const;

  /// Makes it tracked in the pose of a fit, if at least `min_confidence` of its points are seen. Returns whether they
  /// are. `smoothing` is that of ObjectTrackerParams.
  bool accept(const ModelFit& fit, double min_confidence, const FramePair& frames, double smoothing);

private:
  struct Motion
  {
    cv::Point2d center, velocity;
  };

  void clearState();
  cv::Point2d velocityFrom(const Motion& last, double elapsed, double smoothing) const;
  Similarity predictedPose(FramePair& frames) const;
  void updateState();

  ObjectModel model_;
  Features features_;
  Similarity pose_;
  std::vector<std::size_t> seen_;  // indices of the model's points that were seen last
  std::optional<Motion> last_;     // its motion in the last frame, if it was seen there
  int search_round_ = 0;
  TrackedObject state_;
};

}  // namespace robot_vision
