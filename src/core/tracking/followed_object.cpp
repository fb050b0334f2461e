#include "followed_object.hpp"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "core/common/smoothing.hpp"
#include "velocity.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinPoints = 5;             // points that must agree on a similarity
constexpr double kMaxFlowError = 2.0;     // px by which flow may deviate from a similarity
constexpr double kMaxScaleChange = 1.25;  // factor from frame to frame; beyond it five points agree only by chance

}  // namespace

FollowedObject::FollowedObject(int id, const std::string& label, const cv::Mat& gray, const cv::Rect& region,
                               int points)
  : model_(gray, region, points), features_(objectFeatures(gray, region)), pose_(model_.firstPose())
{
  state_.id = id;
  state_.label = label;
  updateState();
}

void FollowedObject::setSeen()
{
  seen_.resize(model_.points().size());
  std::iota(seen_.begin(), seen_.end(), std::size_t{0});
  state_.tracked = true;
  state_.confidence = 1.0;
  state_.points = pose_(model_.points());
}

void FollowedObject::setLost()
{
  clearState();
  last_.reset();
}

void FollowedObject::clearState()
{
  seen_.clear();
  state_.tracked = false;
  state_.confidence = 0.0;
  state_.velocity = {};
  state_.points.clear();
}

void FollowedObject::follow(FramePair& frames, const ObjectTrackerParams& params)
{
  last_ = Motion{state_.center, state_.velocity};
  const ModelFit fit = fitAt(predictedPose(frames), frames, params.min_similarity);
  const double growth = fit.pose.scale() / pose_.scale();
  if (growth > kMaxScaleChange || growth < 1.0 / kMaxScaleChange ||
      !accept(fit, params.min_confidence, frames, params.smoothing))
    clearState();
}

/// The pose that flow gives, or that the velocity gives if the points do not agree.
Similarity FollowedObject::predictedPose(FramePair& frames) const
{
  Similarity predicted = pose_;
  predicted.shift += state_.velocity * frames.elapsed;
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
  return fitSimilarity(from, to, kMaxFlowError, kMinPoints).value_or(predicted);
}

ModelFit FollowedObject::fitAt(const Similarity& pose, FramePair& frames, double min_similarity) const
{
  return model_.fit(frames.newest, frames.flow, pose, min_similarity);
}

bool FollowedObject::accept(const ModelFit& fit, double min_confidence, const FramePair& frames, double smoothing)
{
  const double confidence = static_cast<double>(fit.seen.size()) / static_cast<double>(model_.points().size());
  if (static_cast<int>(fit.seen.size()) < kMinPoints || confidence < min_confidence) return false;
  pose_ = fit.pose;
  seen_ = fit.seen;
  state_.tracked = true;
  state_.confidence = confidence;
  state_.points = fit.positions;
  updateState();
  state_.velocity = last_ ? velocityFrom(*last_, frames.elapsed, smoothing) : cv::Point2d();
  return true;
}

/// The filtered velocity. It is 0 if the object is further than its own size from where the last motion led.
cv::Point2d FollowedObject::velocityFrom(const Motion& last, double elapsed, double smoothing) const
{
  if (elapsed < kMinInterval) return last.velocity;
  const cv::Point2d error = state_.center - last.center - last.velocity * elapsed;
  const std::vector<cv::Point2f> outline(state_.outline.begin(), state_.outline.end());
  if (error.ddot(error) > cv::contourArea(outline)) return {};
  return last.velocity + smoothingGain(elapsed, smoothing) / elapsed * error;
}

/// Writes the pose into the state that users see.
void FollowedObject::updateState()
{
  const std::vector<cv::Point2f>& corners = model_.corners();
  std::transform(corners.begin(), corners.end(), state_.outline.begin(),
                 [this](const cv::Point2f& corner) { return pose_(cv::Point2d(corner)); });
  state_.center = pose_(model_.center());
  state_.scale = pose_.scale() / firstPose().scale();
  state_.angle = pose_.angle();
}

}  // namespace robot_vision
