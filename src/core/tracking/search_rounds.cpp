#include "search_rounds.hpp"

#include <algorithm>

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxSearched = 2;   // objects in a frame; each takes some 10 ms at 640x480
constexpr double kMaxFeaturesAge = 0.25;  // s, in which an object is still near where it was

bool isRecent(double earlier_s, double time_s, double period)
{
  return time_s >= earlier_s && time_s < earlier_s + period;
}

}  // namespace

std::vector<FollowedObject*> SearchRounds::choose(std::vector<FollowedObject*> lost, double time_s, double period)
{
  if (lost.empty())
  {
    is_over_ = true;
    return {};
  }
  if (time_s < began_ || (is_over_ && !isRecent(began_, time_s, period)))
  {
    ++round_;
    began_ = time_s;
    is_over_ = false;
  }
  if (is_over_) return {};

  const auto had_turn = [this](const FollowedObject* object) { return object->searchRound() == round_; };
  lost.erase(std::remove_if(lost.begin(), lost.end(), had_turn), lost.end());
  is_over_ = lost.size() <= kMaxSearched;
  // What was lost just now is near, and has not been searched for in the last rounds.
  std::stable_sort(lost.begin(), lost.end(),
                   [](const FollowedObject* a, const FollowedObject* b)
                   { return a->searchRound() < b->searchRound(); });
  lost.resize(std::min(lost.size(), kMaxSearched));
  for (FollowedObject* object : lost)
    object->setSearchRound(round_);
  return lost;
}

const Features& SearchRounds::features(const cv::Mat& gray, int count, double time_s, double period)
{
  if (!isRecent(features_time_, time_s, std::min(period, kMaxFeaturesAge)) || features_size_ != gray.size())
  {
    features_ = imageFeatures(gray, count);
    features_time_ = time_s;
    features_size_ = gray.size();
  }
  return features_;
}

}  // namespace robot_vision
