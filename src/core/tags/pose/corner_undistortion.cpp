#include "robot_vision/tags/pose/corner_undistortion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace robot_vision
{

namespace
{

using Corners = std::array<cv::Point2d, 4>;

constexpr int kFewest = 16;      // samples of an edge, spaced as the library's are
constexpr double kPixels = 8.0;  // for one of a long edge
constexpr int kRounds = 2;       // the second changes a twentieth of what the first does

struct Line
{
  cv::Point2d point;
  cv::Point2d direction;
};

/// The line for which the squared distances of the points are least.
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

/// Where the lines meet that are fitted to the edges between these corners.
Corners byLines(const Corners& corners, const CameraModel& camera)
{
  std::array<Line, 4> lines;
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const cv::Point2d &begin = corners[i], &end = corners[(i + 1) % corners.size()];
    const cv::Point2d from = camera.ray(begin), to = camera.ray(end);
    const int samples = std::max(kFewest, static_cast<int>(cv::norm(end - begin) / kPixels));
    std::vector<cv::Point2d> points;
    for (int s = 1; s <= samples; ++s)
    {
      const cv::Point2d ray = from + (to - from) * (s / (samples + 1.0));
      points.push_back(camera.project({ray.x, ray.y, 1.0}));
    }
    lines[i] = fitLine(points);
  }
  Corners meeting;
  for (std::size_t i = 0; i < corners.size(); ++i)
    meeting[i] = intersection(lines[(i + 3) % lines.size()], lines[i]);
  return meeting;
}

}  // namespace

std::array<cv::Point2d, 4> withoutBentEdges(const std::array<cv::Point2d, 4>& corners, const CameraModel& camera)
{
  Corners unbent = corners;
  for (int round = 0; round < kRounds; ++round)
  {
    const Corners meeting = byLines(unbent, camera);
    for (std::size_t i = 0; i < corners.size(); ++i)
    {
      unbent[i] += corners[i] - meeting[i];
      if (!std::isfinite(cv::norm(unbent[i]))) return corners;
    }
  }
  return unbent;
}

}  // namespace robot_vision
