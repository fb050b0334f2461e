#pragma once

#include <functional>
#include <limits>

#include "robot_vision/tags/detection/tag_detector.hpp"
#include "tag_pictures.hpp"

/// The largest distance of two corners that are the same.
inline double distance(const TagCorners& a, const TagCorners& b)
{
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, cv::norm(a[i] - b[i]));
  return most;
}

inline std::vector<int> idsOf(const std::vector<robot_vision::Tag>& tags)
{
  std::vector<int> ids;
  for (const robot_vision::Tag& tag : tags)
    ids.push_back(tag.id);
  return ids;
}

/// The largest distance of the corners of tags that are the same in both; infinite if there are others.
inline double difference(const std::vector<robot_vision::Tag>& a, const std::vector<robot_vision::Tag>& b)
{
  if (idsOf(a) != idsOf(b)) return std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, distance(a[i].corners, b[i].corners));
  return most;
}

/// The defaults, changed.
inline robot_vision::TagDetectorParams with(const std::function<void(robot_vision::TagDetectorParams&)>& change)
{
  robot_vision::TagDetectorParams params;
  change(params);
  return params;
}
