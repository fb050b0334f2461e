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

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const TagPoseParams& params);

/// The pose of a bundle, or of a tag, over time.
///
/// The corners are filtered before a pose is made of them, by models of rest and of motion that compete (interacting
/// multiple models; Blom, Bar-Shalom, 1988): those of a tag at rest are averaged over some 20 frames, those of a tag
/// that moves hardly at all. The two poses that they agree with are told apart by what all pictures have said
/// so far, if this one does not. The noise of the corners is what their pictures say of it, or else corner_noise, and
/// is measured by how well they fit together and, at rest, how much they change: what all frames have in common, which
/// pixels and prints make the larger part, does not average out. A part of that moves all corners alike, and shows in
/// no picture: hence lasting_noise, what the calibration leaves of the lens. It is alike in corners that are near each
/// other, of other tags of a bundle, too; of corners without a covariance as much is their own, besides.
///
/// The default lasting_noise is right for a calibration that is off by 0.1 px, root mean square distance over the
/// picture. Before a camera that is known exactly it makes the place across the line of sight too uncertain, and little
/// else: the mean squared error by the covariance is then 0.7 of its degrees of freedom, 0.6 of bundles.
class TagPoseTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TagPoseTracker(const Bundle& bundle, const TagPoseParams& params = TagPoseParams());
  ~TagPoseTracker();
  TagPoseTracker(TagPoseTracker&&) noexcept;
  TagPoseTracker& operator=(TagPoseTracker&&) noexcept;

  const Bundle& bundle() const;

  /// The poses in the frame of `time_s` (s, of any clock), their errors by the corners of this frame. Time that goes
  /// back begins anew. Returns nothing, and throws, as estimatePose() does; also for a time that is not finite.
  std::optional<TagPoses> update(double time_s, const std::vector<TagCorners>& seen, const CameraModel& camera);

  /// px, standard deviation of each coordinate of a corner in the newest frame.
  double cornerNoise() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
