#include "robot_vision/tags/pose/corner_undistortion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace robot_vision
{

namespace
{

using Corners = std::array<cv::Point2d, 4>;

constexpr double kMinSamples = 16.0;    // of an edge, as in the library
constexpr double kMaxSamples = 1000.0;  // of an edge, however far apart its corners are said to be
constexpr double kSampleSpacing = 8.0;  // px, on long edges
constexpr int kIterations = 2;          // the second changes a twentieth of what the first does

struct Line
{
  cv::Point2d point;
  cv::Point2d direction;
};

/// The line with the smallest sum of squared distances from the points.
Line fitLine(const std::vector<cv::Point2d>& points)
{
  cv::Point2d mean;
  for (const cv::Point2d& point : points)
    mean += point / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const cv::Point2d& point : points)
  {
    const cv::Point2d d = point - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {mean, {std::cos(angle), std::sin(angle)}};
}

cv::Point2d intersection(const Line& a, const Line& b)
{
  return a.point + a.direction * ((b.point - a.point).cross(b.direction) / a.direction.cross(b.direction));
}

/// The intersections of the lines that are fitted to the distorted edges between these corners.
Corners lineIntersections(const Corners& corners, const CameraModel& camera)
{
  std::array<Line, 4> lines;
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const cv::Point2d &begin = corners[i], &end = corners[(i + 1) % corners.size()];
    const cv::Point2d from = camera.ray(begin), to = camera.ray(end);
    const double wanted = std::min(kMaxSamples, cv::norm(end - begin) / kSampleSpacing);
    const int samples = static_cast<int>(std::max(kMinSamples, wanted));
    std::vector<cv::Point2d> points;
    for (int s = 1; s <= samples; ++s)
    {
      const cv::Point2d ray = from + (to - from) * (s / (samples + 1.0));
      points.push_back(camera.project({ray.x, ray.y, 1.0}));
    }
    lines[i] = fitLine(points);
  }
  Corners intersections;
  for (std::size_t i = 0; i < corners.size(); ++i)
    intersections[i] = intersection(lines[(i + 3) % lines.size()], lines[i]);
  return intersections;
}

double longestEdge(const Corners& corners)
{
  double longest = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    longest = std::max(longest, cv::norm(corners[(i + 1) % corners.size()] - corners[i]));
  return longest;
}

}  // namespace

std::array<cv::Point2d, 4> withoutBentEdges(const std::array<cv::Point2d, 4>& corners, const CameraModel& camera)
{
  Corners corrected = corners;
  const double max_shift = longestEdge(corners);
  for (int round = 0; round < kIterations; ++round)
  {
    const Corners intersections = lineIntersections(corrected, camera);
    for (std::size_t i = 0; i < corners.size(); ++i)
    {
      const cv::Point2d shift = corners[i] - intersections[i];
      if (!(cv::norm(shift) <= max_shift)) return corners;  // or it is NaN
      corrected[i] += shift;
    }
  }
  return corrected;
}

}  // namespace robot_vision
