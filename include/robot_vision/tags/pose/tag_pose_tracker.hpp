#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "tag_pose.hpp"

namespace robot_vision
{

struct TagPoseParams
{
  double corner_noise = 0.2;
  double lasting_noise = 0.06;
  double max_gap = 0.5;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("corner_noise", &TagPoseParams::corner_noise, Range{0.001, 10}, "px",
          "standard deviation of corners that the image cannot tell, until it has been measured");
    visit("lasting_noise", &TagPoseParams::lasting_noise, Range{0, 10}, "px",
          "standard deviation of each coordinate, of what the calibration leaves of the lens: time does not average "
          "it out, and neighbouring tags share it");
    visit("max_gap", &TagPoseParams::max_gap, Above{0, 60, " to "}, "s",
          "after which a tag or bundle that was not seen has a new pose");
  }
};

/// Tracks the pose of a bundle, or of a single tag, over time.
///
/// The corners are filtered before a pose is computed from them, by interacting multiple models of rest and motion
/// (Blom, Bar-Shalom, 1988): the corners of a tag at rest are averaged over some 20 frames, those of a moving tag
/// hardly at all. If an image does not tell which of its two possible poses is right, the images before it decide.
///
/// The noise of the corners is at first the one of their covariances, or corner_noise. It is then measured by how well
/// the corners of a tag fit together and, at rest, by how much they change from frame to frame. Errors that all frames
/// have in common, mostly due to pixels and prints, do not average out. Those that move all corners alike do not show
/// in any image: lasting_noise stands for them, the error that the calibration of the lens leaves. It is similar in
/// corners near each other, also of different tags of a bundle. Corners without a covariance have as much lasting noise
/// of their own in addition.
///
/// The default lasting_noise suits a calibration with an error of 0.1 px, root mean square over the image. For a camera
/// that is known exactly it makes the position across the line of sight look too uncertain, and little else: the mean
/// squared error by the covariance is then 0.7 times the degrees of freedom, for bundles 0.6 times.
class TagPoseTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TagPoseTracker(const Bundle& bundle, const TagPoseParams& params = TagPoseParams());
  ~TagPoseTracker();

  /// The poses in the frame at `time_s` (s, of any clock); their errors are those of this frame's corners. When time
  /// goes back, the tracker starts anew. The result is empty, and exceptions are thrown, as estimatePose() does; a time
  /// that is not finite throws, too.
  std::optional<TagPoses> update(double time_s, const std::vector<TagCorners>& seen, const CameraModel& camera);

  /// The standard deviation of each coordinate of a corner in the newest frame, px.
  double cornerNoise() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
