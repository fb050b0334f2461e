#include "robot_vision/tracking/box_tracker.hpp"

#include <cmath>
#include <string>

#include "followed_boxes.hpp"
#include "frame_warps.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxPlace = 1e6;  // px, of a detection's corners

bool isPlace(double value)
{
  return std::abs(value) <= kMaxPlace;
}

void checkDetection(const BoxDetection& detection, std::size_t index)
{
  const cv::Rect2d& box = detection.box;
  const double right = box.x + box.width, bottom = box.y + box.height;
  const bool is_box =
      isPlace(box.x) && isPlace(box.y) && isPlace(right) && isPlace(bottom) && box.width >= 0.0 && box.height >= 0.0;
  const bool is_score = detection.score >= 0.0 && detection.score <= 1.0;
  if (is_box && is_score) return;
  const std::string name = "detections[" + std::to_string(index) + "]";
  requireRange(name + ".score", detection.score, 0.0, 1.0);
  require(false, name + ".box",
          "(" + toText(box.x) + ", " + toText(box.y) + ", " + toText(right) + ", " + toText(bottom) + ")",
          "x0, y0, x1, y1 with x0 <= x1 and y0 <= y1, from -1e6 to 1e6 px");
}

}  // namespace

void validate(const BoxTrackerParams& params)
{
  checkFields(params);
  require(params.low_score <= params.high_score, "low_score", params.low_score,
          "at most high_score, " + toText(params.high_score));
}

struct BoxTracker::Impl
{
  void restart(double time_s)
  {
    boxes.clear();
    frames.start(time_s);
  }

  bool isPast(double time_s) const { return !frames.empty() && time_s < frames.newest(); }

  void addFrame(double time_s, const std::optional<Warp>& warp)
  {
    if (frames.empty() || isPast(time_s) || !frames.add(time_s, warp.value_or(Warp(1, 0, 0, 0, 1, 0)))) restart(time_s);
  }

  BoxTrackerParams params;
  FrameWarps frames;  // from that of the last result to the newest
  FollowedBoxes boxes;
  int left_out = 0;
};

BoxTracker::BoxTracker(const BoxTrackerParams& params) : impl_(std::make_unique<Impl>())
{
  configure(params);
}

BoxTracker::~BoxTracker() = default;
BoxTracker::BoxTracker(BoxTracker&&) noexcept = default;
BoxTracker& BoxTracker::operator=(BoxTracker&&) noexcept = default;

void BoxTracker::configure(const BoxTrackerParams& params)
{
  validate(params);
  impl_->params = params;
}

std::vector<BoxTrack> BoxTracker::update(double time_s, const std::vector<BoxDetection>& detections,
                                         const std::optional<cv::Matx23d>& warp)
{
  Impl& me = *impl_;
  requireFinite("time_s", time_s);
  if (warp) checkWarp(*warp);
  for (std::size_t i = 0; i < detections.size(); ++i)
    checkDetection(detections[i], i);
  const bool is_late = me.isPast(time_s) && time_s >= me.frames.origin();
  require(!warp || !is_late, "warp", "given for a frame of the past", "none, as the motion to that frame is known");

  if (!is_late) me.addFrame(time_s, warp);
  const double elapsed = time_s - me.frames.origin();
  const Warp from_last = me.frames.moveOrigin(time_s);
  me.boxes.moveTo(time_s, elapsed, from_last, me.params);
  me.left_out = me.boxes.associate(time_s, detections, me.params);
  return me.boxes.reports(time_s, me.params);
}

std::vector<BoxTrack> BoxTracker::predict(double time_s, const std::optional<cv::Matx23d>& warp)
{
  Impl& me = *impl_;
  requireFinite("time_s", time_s);
  if (warp) checkWarp(*warp);
  me.addFrame(time_s, warp);
  return me.boxes.predictions(time_s, time_s - me.frames.origin(), me.frames.toNewest(), me.params);
}

int BoxTracker::leftOut() const
{
  return impl_->left_out;
}

void BoxTracker::clear()
{
  impl_->boxes.clear();
}

}  // namespace robot_vision
