#pragma once

#include <cstdint>
#include <vector>

#include "box_association.hpp"
#include "followed_box.hpp"
#include "frame_warps.hpp"
#include "robot_vision/tracking/box_tracker.hpp"

namespace robot_vision
{

/// The tracks of a BoxTracker, where they are in the frame of the last result.
class FollowedBoxes
{
public:
  void clear();

  /// Has them be where they are expected in another frame, `elapsed` s after that of the last result, and forgets those
  /// that were not seen for max_age then.
  void moveTo(double time_s, double elapsed, const Warp& warp, const BoxTrackerParams& params);

  /// Associates them with what was found in the frame that they were moved to. Returns how many detections were not
  /// used for want of room or of area.
  int associate(double time_s, const std::vector<BoxDetection>& detections, const BoxTrackerParams& params);

  /// The confirmed ones in the frame of the last result.
  std::vector<BoxTrack> reports(double time_s, const BoxTrackerParams& params) const;

  /// The confirmed ones in a later frame, `elapsed` s after that of the last result.
  std::vector<BoxTrack> predictions(double time_s, double elapsed, const Warp& warp,
                                    const BoxTrackerParams& params) const;

private:
  template <class IsWanted>
  std::vector<BoxCandidate> candidates(const IsWanted& is_wanted) const;

  void pair(std::vector<BoxCandidate>& tracks, std::vector<BoxCandidate>& found, double min_iou,
            const std::vector<BoxDetection>& detections, double time_s, const BoxTrackerParams& params);
  void setUnseenLost();
  void confirm(int min_hits);

  std::vector<FollowedBox> boxes_;
  std::int64_t last_id_ = 0;
};

}  // namespace robot_vision
