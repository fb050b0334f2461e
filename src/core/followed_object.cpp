#include "followed_object.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace robot_vision
{
namespace
{

constexpr int kFewestPoints = 5;    // that a similarity is believed by
constexpr double kTolerance = 2.0;  // px by which flow may differ from a similarity

}  // namespace

FollowedObject::FollowedObject(int id, const std::string& label, const cv::Mat& gray, const cv::Rect& region,
                               int points)
  : model_(gray, region, points), features_(objectFeatures(gray, region)), pose_(model_.firstPose())
{
  state_.id = id;
  state_.label = label;
  describe();
}

void FollowedObject::markSeen()
{
  seen_.resize(model_.points().size());
  std::iota(seen_.begin(), seen_.end(), std::size_t{0});
  state_.tracked = true;
  state_.confidence = 1.0;
  state_.points = pose_(model_.points());
}

void FollowedObject::lose()
{
  seen_.clear();
  state_.tracked = false;
  state_.confidence = 0.0;
  state_.velocity = {};
  state_.points.clear();
}

void FollowedObject::follow(FramePair& frames, const ObjectTrackerParams& params)
{
  const cv::Point2d before = state_.center;
  if (!accept(fitAt(startOf(frames), frames, params.min_similarity), params.min_confidence)) return lose();
  if (!frames.measurable()) return;
  const double share = params.smoothing > 0.0 ? 1.0 - std::exp(-frames.passed / params.smoothing) : 1.0;
  state_.velocity += share * ((state_.center - before) / frames.passed - state_.velocity);
}

/// Where flow has brought it, as far as its points agree; else where its velocity has.
Similarity FollowedObject::startOf(FramePair& frames) const
{
  Similarity predicted = pose_;
  predicted.shift += state_.velocity * frames.passed;
  std::vector<cv::Point2f> of_model, points;
  for (const std::size_t i : seen_)
  {
    of_model.push_back(model_.points()[i]);
    points.emplace_back(pose_(cv::Point2d(of_model.back())));
  }
  const FollowedPoints moved = followPoints(frames.last, frames.newest, frames.flow, points, predicted(of_model));
  std::vector<cv::Point2f> from, to;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!moved.found[i]) continue;
    from.push_back(of_model[i]);
    to.push_back(moved.positions[i]);
  }
  return fitSimilarity(from, to, kTolerance, kFewestPoints).value_or(predicted);
}

ModelFit FollowedObject::fitAt(const Similarity& pose, FramePair& frames, double min_similarity) const
{
  return model_.fit(frames.newest, frames.flow, pose, min_similarity);
}

bool FollowedObject::accept(const ModelFit& fit, double min_confidence)
{
  const double confidence = static_cast<double>(fit.seen.size()) / static_cast<double>(model_.points().size());
  if (static_cast<int>(fit.seen.size()) < kFewestPoints || confidence < min_confidence) return false;
  pose_ = fit.pose;
  seen_ = fit.seen;
  state_.tracked = true;
  state_.confidence = confidence;
  state_.points = fit.where;
  describe();
  return true;
}

/// Writes the pose into the state.
void FollowedObject::describe()
{
  const std::vector<cv::Point2f>& corners = model_.corners();
  std::transform(corners.begin(), corners.end(), state_.outline.begin(),
                 [this](const cv::Point2f& corner) { return pose_(cv::Point2d(corner)); });
  state_.center = pose_(model_.center());
  state_.scale = pose_.scale() / firstPose().scale();
  state_.angle = pose_.angle();
}

}  // namespace robot_vision
