#include "keypoint_flow.hpp"

#include <algorithm>
#include <utility>

namespace robot_vision
{

void KeypointFlow::add(const cv::Mat& gray)
{
  std::swap(last_, newest_);
  newest_.set(gray);
}

KeypointMatches KeypointFlow::follow(const std::vector<cv::KeyPoint>& keypoints)
{
  std::vector<cv::Point2f> points;
  cv::KeyPoint::convert(keypoints, points);
  const FollowedPoints moved = followPoints(last_, newest_, params_, points, points);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (moved.found[i] && isInside(newest_.size(), moved.positions[i])) found.push_back(i);
  std::stable_sort(found.begin(), found.end(),
                   [&moved](std::size_t a, std::size_t b) { return moved.errors[a] < moved.errors[b]; });
  KeypointMatches matches;
  for (const std::size_t i : found)
  {
    matches.from.push_back(points[i]);
    matches.to.push_back(moved.positions[i]);
    matches.distances.push_back(moved.errors[i]);
  }
  matches.inliers.resize(found.size());
  return matches;
}

}  // namespace robot_vision
