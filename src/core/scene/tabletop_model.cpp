#include "tabletop_model.hpp"

#include <algorithm>
#include <cmath>

#include "robot_vision/scene/tabletop_scene.hpp"

namespace robot_vision::scene
{
namespace
{

const double kTopThickness = 0.03, kLegWidth = 0.12;  // m
const double kEdge = 0.02, kGap = 0.025;              // m, from discs to the table's edge, and between them

/// The four upright sides of a block around (kSceneTableDistance, 0), of this size to the left and forward.
void addSides(std::vector<Board>& boards, const cv::Size2d& size, double low, double high)
{
  const double x = size.height / 2.0, y = size.width / 2.0, z = (low + high) / 2.0, quarter = CV_PI / 2.0;
  const cv::Vec3d middle(kSceneTableDistance, 0.0, z);
  boards.push_back(upright(middle + cv::Vec3d(x, 0, 0), 2.0 * quarter, {size.width, high - low}));
  boards.push_back(upright(middle + cv::Vec3d(0, y, 0), -quarter, {size.height, high - low}));
  boards.push_back(upright(middle - cv::Vec3d(0, y, 0), quarter, {size.height, high - low}));
  boards.push_back(upright(middle - cv::Vec3d(x, 0, 0), 0.0, {size.width, high - low}));
}

}  // namespace

cv::Affine3d tabletopCamera(double seconds)
{
  const double phase = 2.0 * CV_PI * seconds / kScenePeriod, widest = 40.0 * CV_PI / 180.0;
  const double around = widest * std::sin(phase);
  const double away = 0.62 + 0.03 * std::cos(2.0 * phase);                       // m, across the floor
  const double above = kSceneTableHeight + 0.62 + 0.04 * std::sin(phase + 1.0);  // m
  const cv::Vec3d eye(kSceneTableDistance - away * std::cos(around), -away * std::sin(around), above);
  const cv::Vec3d target(kSceneTableDistance + 0.01 * std::sin(2.0 * phase), 0.0, kSceneTableHeight + 0.06);
  return lookingAt(eye, target, 0.02 * std::sin(phase + 2.0));
}

std::vector<Board> tableSides()
{
  std::vector<Board> boards;
  const double below = kSceneTableHeight - kTopThickness;
  addSides(boards, {kLegWidth, kLegWidth}, 0.0, below);
  addSides(boards, kSceneTableSize, below, kSceneTableHeight);
  return boards;
}

Board tableTop()
{
  return onFloor(kSceneTableDistance, 0.0, kSceneTableSize, kSceneTableHeight);
}

std::vector<cv::Point2d> placesOnTable(const std::vector<double>& radii)
{
  const double step = 0.0085;  // m, of a spiral whose points are spread evenly
  std::vector<cv::Point2d> candidates, places;
  for (int number = 0; number < 4000; ++number)
  {
    const double angle = number * CV_PI * (3.0 - std::sqrt(5.0)), away = step * std::sqrt(number);
    candidates.emplace_back(away * std::cos(angle), away * std::sin(angle));
  }
  for (const double radius : radii)
  {
    const double x = kSceneTableSize.height / 2.0 - kEdge - radius, y = kSceneTableSize.width / 2.0 - kEdge - radius;
    const auto fits = [&](const cv::Point2d& at)
    {
      if (std::abs(at.x) > x || std::abs(at.y) > y) return false;
      for (std::size_t i = 0; i < places.size(); ++i)
        if (cv::norm(at - places[i]) < radius + radii[i] + kGap) return false;
      return true;
    };
    const auto found = std::find_if(candidates.begin(), candidates.end(), fits);
    if (found == candidates.end()) break;
    places.push_back(*found);
  }
  for (cv::Point2d& place : places)
    place.x += kSceneTableDistance;
  return places;
}

}  // namespace robot_vision::scene
