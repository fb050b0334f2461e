#include "followed_box.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr double kStart = 0.5;           // sides, by which what was at rest may have moved
constexpr double kMaxClassWeight = 5.0;  // so that a track whose class was wrong for long gets another one in the end

}  // namespace

FollowedBox::FollowedBox(const BoxDetection& detection, std::size_t index, double time_s,
                         const BoxTrackerParams& params)
  : motion_(detection.box, params),
    detection_(static_cast<int>(index)),
    class_id_(detection.class_id),
    class_weight_(detection.score),
    score_(detection.score),
    seen_s_(time_s)
{
}

double FollowedBox::reach(double time_s, const BoxTrackerParams& params) const
{
  const double side = std::sqrt(motion_.box().area()), longest = params.reach * side;
  if (hits_ < 2) return longest;
  return std::min(longest, kStart * side + 2.0 * cv::norm(motion_.velocity()) * (time_s - seen_s_));
}

void FollowedBox::predict(const Warp& warp, double elapsed, const BoxTrackerParams& params)
{
  motion_.predict(warp, elapsed, params);
}

void FollowedBox::setSeen(const BoxDetection& detection, std::size_t index, double time_s,
                          const BoxTrackerParams& params)
{
  detection_ = static_cast<int>(index);
  motion_.correct(detection.box, time_s - seen_s_, params);
  countClass(detection);
  score_ = detection.score;
  seen_s_ = time_s;
  ++hits_;
  lost_ = false;
}

void FollowedBox::setLost()
{
  motion_.keepSize();
  lost_ = true;
}

BoxTrack FollowedBox::report(double time_s) const
{
  BoxTrack track;
  track.id = id_;
  track.class_id = class_id_;
  track.score = score_;
  track.box = motion_.box();
  track.velocity = motion_.velocity();
  track.predicted = time_s != seen_s_;
  track.lost = lost_;
  track.age = time_s - seen_s_;
  track.detection = detection_;
  return track;
}

/// The majority vote of Boyer and Moore, weighted by the scores: it needs no list of classes.
void FollowedBox::countClass(const BoxDetection& detection)
{
  class_weight_ += detection.class_id == class_id_ ? detection.score : -detection.score;
  if (class_weight_ < 0.0)
  {
    class_id_ = detection.class_id;
    class_weight_ = -class_weight_;
  }
  class_weight_ = std::min(class_weight_, kMaxClassWeight);
}

}  // namespace robot_vision
