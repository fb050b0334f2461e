#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct BoxTrackerParams
{
  double high_score = 0.5;
  double low_score = 0.1;
  double min_iou = 0.2;
  double min_unsure_iou = 0.5;
  double min_new_iou = 0.3;
  bool mix_classes = false;
  int min_hits = 2;
  double gate = 4.0;
  double reach = 2.0;
  double max_age = 3.0;
  double max_prediction = 0.4;
  double measurement_noise = 0.05;
  double acceleration = 1.0;
  double growth = 0.3;
  double initial_speed = 2.0;
  int max_boxes = 300;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("high_score", &BoxTrackerParams::high_score, Range{0, 1}, "",
          "score from which a detection is sure, and may begin a track");
    visit("low_score", &BoxTrackerParams::low_score, Range{0, 1}, "",
          "score from which an unsure detection may continue a track; those below are left out");
    visit("min_iou", &BoxTrackerParams::min_iou, Range{0.01, 1}, "",
          "least intersection over union of a sure detection and a track that it may be");
    visit("min_unsure_iou", &BoxTrackerParams::min_unsure_iou, Range{0.01, 1}, "", "the same of an unsure detection");
    visit("min_new_iou", &BoxTrackerParams::min_new_iou, Range{0.01, 1}, "",
          "the same of a sure detection and a track that is not confirmed yet");
    visit("mix_classes", &BoxTrackerParams::mix_classes, Anything{}, "",
          "a detection may continue a track of another class, which then has the class that most detections had");
    visit("min_hits", &BoxTrackerParams::min_hits, Range{1, 100}, "",
          "detections in results one after the other that confirm a track; unconfirmed ones are not reported");
    visit("gate", &BoxTrackerParams::gate, Range{1, 100}, "",
          "standard deviations from where a track is expected to a detection that may be it, if they overlap by less "
          "than a half");
    visit("reach", &BoxTrackerParams::reach, Range{0, 10}, "sides",
          "from where a track is expected to a sure detection of about its width and height that may be it without an "
          "overlap, if the result before had it; for what moves by its own size from one result to the next; 0: none");
    visit("max_age", &BoxTrackerParams::max_age, Above{0, 60}, "s",
          "longest time since a track was seen after which it is still known; longer than from one result to the next");
    visit("max_prediction", &BoxTrackerParams::max_prediction, Range{0, 60}, "s",
          "longest time since a track was seen for which it is reported although a result did not have it");
    visit("measurement_noise", &BoxTrackerParams::measurement_noise, Range{0.001, 1}, "sides",
          "error of a detection: standard deviation of centre, width and height; a side is the root of the box's area");
    visit("acceleration", &BoxTrackerParams::acceleration, Range{0, 100}, "sides/s^1.5",
          "how fast the motion changes: root of the spectral density of the centre's acceleration");
    visit("growth", &BoxTrackerParams::growth, Range{0, 100}, "sides/s^1.5", "the same of width and height");
    visit("initial_speed", &BoxTrackerParams::initial_speed, Range{0, 100}, "sides/s",
          "standard deviation of the velocity that a new track may have");
    visit("max_boxes", &BoxTrackerParams::max_boxes, Range{1, 1000}, "",
          "detections of one result that are used, the surest ones, and tracks that there may be");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, or a low_score above high_score.
void validate(const BoxTrackerParams& params);

/// What a detector has found in a frame.
struct BoxDetection
{
  int class_id = 0;
  double score = 0.0;  // 0 to 1
  cv::Rect2d box;      // px
};

/// One track in a frame.
struct BoxTrack
{
  std::int64_t id = 0;     // 1, 2, ... in the order in which tracks are confirmed; never used again
  int class_id = 0;        // that most of its detections had
  double score = 0.0;      // of its last detection
  cv::Rect2d box;          // px, filtered; it may reach out of the image
  cv::Point2d velocity;    // px/s of the centre, by its own motion: without the camera's, where that is known
  bool predicted = false;  // not seen in this frame
  bool lost = false;       // the newest result, which may be one of an earlier frame, did not have it
  double age = 0.0;        // s from the frame in which it was seen last to this one; 0 if it was seen in this one
  int detection = -1;      // index of its detection in the list that update() was given; -1 if there is none
};

/// Gives the boxes that a detector finds ids that stay, and tells where they are in frames that it does not see.
///
/// Each result is associated with the tracks in the manner of ByteTrack (Zhang et al.: ByteTrack: Multi-Object Tracking
/// by Associating Every Detection Box, ECCV 2022): first the sure detections with all confirmed tracks, then the unsure
/// ones with those tracks that are left and that the result before had, then the sure ones that are left with these and
/// with tracks that are not confirmed. Each time the sum of what the pairs' intersections over union exceed their least
/// by is the largest there is. A sure detection that is left begins a track. A track that is not confirmed goes when a
/// result does not have it; a confirmed one is lost then, and goes when it was not seen for max_age.
///
/// A detector that sees every fourth frame needs more than that. What overlaps by less than a half must have about the
/// same size, and be where the track's motion may have led it: a false detection beside a thing that was missed for
/// once does not take its track. In the last step such a pair need not overlap at all, within `reach`, and not farther
/// than half of a side plus what turning back amounts to, if the velocity is known: so what moves by its own size from
/// one result to the next is followed, and what bounces. Its filter begins anew.
///
/// Between results a box moves by a Kalman filter with constant velocity of its centre, its width and its height. The
/// camera's motion, if it is told, moves it first: see CameraMotion. That is exact for similarities; of other affine
/// warps the variances grow as areas do.
///
/// The detector may be slower than the camera, and its result may come when other frames have followed. Then call
///
/// - predict(time, warp) for every frame at once, in the order of the frames. It returns where the tracks are in it;
/// - update(time of the frame that the result is of, detections), without a warp, when the result is there, before the
///   predict() of the next frame. It returns the tracks in that frame of the past, and which detections they are. What
///   the camera has done since is remembered, and the next predict() starts from the corrected tracks.
///
/// What follows is the same as if the result had been there in time. Results must come in the order of their frames. If
/// a frame's result is there before the next frame, update(time, detections, warp) alone will do, without predict().
///
/// Times are s of any clock. A frame before the newest one, a result before the last one, and a jump by more than
/// max_age begin anew: no track is left. So does a camera's motion after which nothing of the last result's frame can
/// be in view. Ids go on. No clock is read. Not thread-safe.
class BoxTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit BoxTracker(const BoxTrackerParams& params = BoxTrackerParams());
  ~BoxTracker();
  BoxTracker(BoxTracker&&) noexcept;
  BoxTracker& operator=(BoxTracker&&) noexcept;

  /// Sets the parameters from the next call on. Tracks are kept. Throws std::invalid_argument as validate() does.
  void configure(const BoxTrackerParams& params);

  /// The detector's result for the frame at `time_s`, which is a new one, the newest, or one of the past. Returns the
  /// confirmed tracks in that frame, in the order of their ids.
  ///
  /// `warp` takes pixels of the newest frame, that of the last call, to those of this one (CameraMotion). Without it
  /// the camera does not move.
  ///
  /// A detection with a side below 0.1 px is left out, and so are more of them than max_boxes: see leftOut(). Throws
  /// std::invalid_argument, and changes nothing, for a time that is not finite, for a score or a box that is none,
  /// naming its index, for a warp that is not finite, mirrors the image or makes it more than 10 times as large or as
  /// small, and for one of a frame of the past.
  std::vector<BoxTrack> update(double time_s, const std::vector<BoxDetection>& detections,
                               const std::optional<cv::Matx23d>& warp = std::nullopt);

  /// A new frame, or again the newest, of which there is no result: where the confirmed tracks are in it, in the order
  /// of their ids. `warp` and errors are those of update().
  std::vector<BoxTrack> predict(double time_s, const std::optional<cv::Matx23d>& warp = std::nullopt);

  /// How many detections of the last result there was no room for, or which had no area.
  int leftOut() const;

  /// Forgets all tracks. Ids go on.
  void clear();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
