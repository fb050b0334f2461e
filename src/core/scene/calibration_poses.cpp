#include "calibration_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene_view.hpp"

namespace robot_vision::scene
{

namespace
{

// Times the distance at which a board that faces the camera fills the image.
const double kMinDistance = 0.95, kMaxDistance = 2.2;
const double kMinTilt = 0.25, kMaxTilt = 0.8;  // rad, out of the image plane
const double kMaxRoll = 0.35;                  // rad, in the image plane
// The board's place is drawn from a range that is this much wider than the possible one and then clamped. This often
// puts it at the image's border, where a lens distorts most.
const double kPlaceSpread = 1.5;

// What is drawn for each view: evenly over its range and independent of the others.
enum Dimension
{
  kAxis = 1,
  kTilt,
  kRoll,
  kDistance,
  kAcross,
  kDown,
};

// A point of a quasirandom sequence in six dimensions, 0 to 1 in each. The sequence fills them evenly however many
// points are taken; its steps are powers of the root of x^7 = x + 1. Source: M. Roberts, The Unreasonable Effectiveness
// of Quasirandom Sequences, 2018.
double quasirandom(int number, Dimension dimension)
{
  const double root = 1.1127756842787055;
  const double multiple = 0.5 + number * std::pow(root, -dimension);
  return multiple - std::floor(multiple);
}

double interpolate(double low, double high, double part)
{
  return low + (high - low) * part;
}

// The board_rotation of the board in a view. Its tilt is never small, because a board that faces the camera squarely
// tells little about the camera.
cv::Matx33d boardRotation(int number)
{
  const double axis = 2.0 * CV_PI * quasirandom(number, kAxis);
  const double tilt = interpolate(kMinTilt, kMaxTilt, quasirandom(number, kTilt));
  const double roll = interpolate(-kMaxRoll, kMaxRoll, quasirandom(number, kRoll));
  const cv::Affine3d facing(cv::Vec3d(CV_PI, 0, 0));  // y points up and z towards the camera
  const cv::Affine3d tilted(cv::Vec3d(tilt * std::cos(axis), tilt * std::sin(axis), 0));
  return (facing * tilted * cv::Affine3d(cv::Vec3d(0, 0, roll))).rotation();
}

struct Interval
{
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
};

// The range that the board's middle may have along one axis (x or y) so that all corners, given relative to it, are
// seen by rays whose slopes along that axis are in `slopes`.
Interval middleRange(const Polygon3& board_corners, double cv::Point3d::*axis, double distance, const Interval& slopes)
{
  Interval range;
  for (const cv::Point3d& p : board_corners)
  {
    range.low = std::max(range.low, slopes.low * (distance + p.z) - p.*axis);
    range.high = std::min(range.high, slopes.high * (distance + p.z) - p.*axis);
  }
  return range;
}

// The slopes of the image's rays along one axis for a lens without distortion. A lens with barrel distortion sees more.
Interval raySlopes(double middle, double focal, int pixels)
{
  return {-(middle + 0.5) / focal, (pixels - 0.5 - middle) / focal};
}

double place(const Interval& range, double part)
{
  return interpolate(range.low, range.high, std::clamp(0.5 + kPlaceSpread * (part - 0.5), 0.0, 1.0));
}

}  // namespace

cv::Affine3d shownBoard(int view, const cv::Size2d& size, const CameraModel& camera)
{
  const cv::Affine3d board_rotation(boardRotation(view));
  const Polygon3 board_corners = corners(board_rotation, size);
  const Interval columns = raySlopes(camera.K(0, 2), camera.K(0, 0), camera.width);
  const Interval rows = raySlopes(camera.K(1, 2), camera.K(1, 1), camera.height);
  const double filling_distance =
      std::max(size.width / (columns.high - columns.low), size.height / (rows.high - rows.low));
  const double step = 1.05;
  for (double distance = filling_distance * interpolate(kMinDistance, kMaxDistance, quasirandom(view, kDistance));;
       distance *= step)
  {
    const Interval x = middleRange(board_corners, &cv::Point3d::x, distance, columns);
    const Interval y = middleRange(board_corners, &cv::Point3d::y, distance, rows);
    if (x.low > x.high || y.low > y.high) continue;
    return cv::Affine3d(board_rotation.rotation(),
                        {place(x, quasirandom(view, kAcross)), place(y, quasirandom(view, kDown)), distance});
  }
}

}  // namespace robot_vision::scene
