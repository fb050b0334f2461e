#include "followed_boxes.hpp"

#include <algorithm>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr double kMinSide = 0.1;  // px, of a detection that is used

/// The indices of the detections that are used, at most `count`, the surest ones.
std::vector<std::size_t> surest(const std::vector<BoxDetection>& detections, std::size_t count)
{
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < detections.size(); ++i)
    if (std::min(detections[i].box.width, detections[i].box.height) >= kMinSide) indices.push_back(i);
  if (indices.size() <= count) return indices;
  std::stable_sort(indices.begin(), indices.end(),
                   [&](std::size_t a, std::size_t b) { return detections[a].score > detections[b].score; });
  indices.resize(count);
  return indices;
}

/// Takes what a function is true of out of a list.
template <class T, class Is>
void removeWhat(std::vector<T>& list, const Is& is)
{
  list.erase(std::remove_if(list.begin(), list.end(), is), list.end());
}

bool isReported(const FollowedBox& box, double time_s, const BoxTrackerParams& params)
{
  const double longest = box.isLost() ? std::min(params.max_prediction, params.max_age) : params.max_age;
  return box.isConfirmed() && time_s - box.lastSeen() <= longest;
}

std::vector<BoxTrack> byId(std::vector<BoxTrack> tracks)
{
  std::sort(tracks.begin(), tracks.end(), [](const BoxTrack& a, const BoxTrack& b) { return a.id < b.id; });
  return tracks;
}

}  // namespace

void FollowedBoxes::clear()
{
  boxes_.clear();
}

void FollowedBoxes::moveTo(double time_s, double elapsed, const Warp& warp, const BoxTrackerParams& params)
{
  removeWhat(boxes_, [&](const FollowedBox& box) { return time_s - box.lastSeen() > params.max_age; });
  for (FollowedBox& box : boxes_)
    box.predict(warp, elapsed, params);
}

int FollowedBoxes::associate(double time_s, const std::vector<BoxDetection>& detections, const BoxTrackerParams& params)
{
  const auto max_boxes = static_cast<std::size_t>(params.max_boxes);
  const std::vector<std::size_t> used = surest(detections, max_boxes);
  std::vector<BoxCandidate> sure, unsure;
  for (const std::size_t i : used)
  {
    const auto& [class_id, score, box] = detections[i];
    if (score < params.low_score) continue;
    (score >= params.high_score ? sure : unsure).push_back({i, class_id, box, BoxMotion::varianceOf(box, params)});
  }
  for (FollowedBox& box : boxes_)
    box.beginResult();
  std::vector<BoxCandidate> known = candidates([](const FollowedBox& box) { return box.isConfirmed(); });
  pair(known, sure, params.min_iou, detections, time_s, params);
  // Only a sure detection that overlaps it can be one that was lost: where that is gets less certain with time.
  removeWhat(known, [&](const BoxCandidate& track) { return boxes_[track.index].isLost(); });
  pair(known, unsure, params.min_unsure_iou, detections, time_s, params);
  // Last of all what needs no overlap, so that nothing is taken from where it is more likely to belong.
  std::vector<BoxCandidate> moving = candidates([](const FollowedBox& box) { return !box.isConfirmed(); });
  moving.insert(moving.end(), known.begin(), known.end());
  for (BoxCandidate& track : moving)
    track.reach = boxes_[track.index].reach(time_s, params);
  pair(moving, sure, params.min_new_iou, detections, time_s, params);
  setUnseenLost();

  const std::size_t begun = std::min(sure.size(), max_boxes - std::min(max_boxes, boxes_.size()));
  for (std::size_t i = 0; i < begun; ++i)
    boxes_.emplace_back(detections[sure[i].index], sure[i].index, time_s, params);
  confirm(params.min_hits);
  return static_cast<int>(detections.size() - used.size() + sure.size() - begun);
}

template <class IsWanted>
std::vector<BoxCandidate> FollowedBoxes::candidates(const IsWanted& is_wanted) const
{
  std::vector<BoxCandidate> found;
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    if (is_wanted(boxes_[i])) found.push_back({i, boxes_[i].classId(), boxes_[i].box(), boxes_[i].centerVariance()});
  return found;
}

void FollowedBoxes::pair(std::vector<BoxCandidate>& tracks, std::vector<BoxCandidate>& found, double min_iou,
                         const std::vector<BoxDetection>& detections, double time_s, const BoxTrackerParams& params)
{
  for (const auto& [track, detection] : takePairs(tracks, found, {min_iou, params.gate, params.mix_classes}))
    boxes_[track].setSeen(detections[detection], detection, time_s, params);
}

void FollowedBoxes::setUnseenLost()
{
  for (FollowedBox& box : boxes_)
    if (!box.hasDetection()) box.setLost();
  removeWhat(boxes_, [](const FollowedBox& box) { return box.isLost() && !box.isConfirmed(); });
}

void FollowedBoxes::confirm(int min_hits)
{
  for (FollowedBox& box : boxes_)
    if (!box.isConfirmed() && box.hits() >= min_hits) box.confirm(++last_id_);
}

std::vector<BoxTrack> FollowedBoxes::reports(double time_s, const BoxTrackerParams& params) const
{
  std::vector<BoxTrack> tracks;
  for (const FollowedBox& box : boxes_)
    if (isReported(box, time_s, params)) tracks.push_back(box.report(time_s));
  return byId(std::move(tracks));
}

std::vector<BoxTrack> FollowedBoxes::predictions(double time_s, double elapsed, const Warp& warp,
                                                 const BoxTrackerParams& params) const
{
  std::vector<BoxTrack> tracks;
  for (FollowedBox box : boxes_)
  {
    if (!isReported(box, time_s, params)) continue;
    box.beginResult();
    box.predict(warp, elapsed, params);
    tracks.push_back(box.report(time_s));
  }
  return byId(std::move(tracks));
}

}  // namespace robot_vision
