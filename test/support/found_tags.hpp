#pragma once

#include <functional>
#include <limits>

#include "robot_vision/tags/detection/tag_detector.hpp"
#include "tag_images.hpp"

/// The largest distance between corresponding corners.
inline double distance(const TagCorners& a, const TagCorners& b)
{
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, cv::norm(a[i] - b[i]));
  return largest;
}

/// The errors of the corners' coordinates, x and y of each (px).
inline cv::Vec<double, 8> cornerErrors(const TagCorners& corners, const TagCorners& truth)
{
  cv::Vec<double, 8> off;
  for (int i = 0; i < 4; ++i)
  {
    const cv::Point2d d = corners[static_cast<std::size_t>(i)] - truth[static_cast<std::size_t>(i)];
    off[2 * i] = d.x;
    off[2 * i + 1] = d.y;
  }
  return off;
}

/// Corners with noise of a standard deviation (px).
inline TagCorners shaken(TagCorners corners, double deviation, cv::RNG& random)
{
  for (cv::Point2d& corner : corners)
    corner += cv::Point2d(random.gaussian(deviation), random.gaussian(deviation));
  return corners;
}

inline std::vector<int> idsOf(const std::vector<robot_vision::Tag>& tags)
{
  std::vector<int> ids;
  for (const robot_vision::Tag& tag : tags)
    ids.push_back(tag.id);
  return ids;
}

/// The largest distance between corresponding corners of two lists of tags; infinite if their ids differ.
inline double difference(const std::vector<robot_vision::Tag>& a, const std::vector<robot_vision::Tag>& b)
{
  if (idsOf(a) != idsOf(b)) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, distance(a[i].corners, b[i].corners));
  return largest;
}

/// The default parameters with a change.
inline robot_vision::TagDetectorParams with(const std::function<void(robot_vision::TagDetectorParams&)>& change)
{
  robot_vision::TagDetectorParams params;
  change(params);
  return params;
}
