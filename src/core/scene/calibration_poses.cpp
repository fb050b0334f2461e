#include "calibration_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scene_view.hpp"

namespace robot_vision::scene
{

namespace
{

// Times the distance at which a board that faces the camera fills the picture.
const double kNearest = 0.95, kFarthest = 2.2;
const double kMinTilt = 0.25, kMaxTilt = 0.8;  // rad, out of the plane of the picture
const double kMaxRoll = 0.35;                  // rad, in it
const double kToTheBorder = 1.5;  // so often the room there is: most of a lens's distortion is at the border

// What is chosen for a view, each evenly over its range and independent of the others.
enum Choice
{
  kAxis = 1,
  kTilt,
  kRoll,
  kDistance,
  kAcross,
  kDown,
};

// From 0 to 1. Six dimensions are filled evenly, however many points are taken, by multiples of the powers of the root
// of x^7 = x + 1: M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
double spread(int number, Choice choice)
{
  const double root = 1.1127756842787055;
  const double multiple = 0.5 + number * std::pow(root, -choice);
  return multiple - std::floor(multiple);
}

double between(double low, double high, double part)
{
  return low + (high - low) * part;
}

// The tilt's angle is never small: a board that faces the camera tells little of it.
cv::Matx33d turnOf(int number)
{
  const double axis = 2.0 * CV_PI * spread(number, kAxis);
  const double tilt = between(kMinTilt, kMaxTilt, spread(number, kTilt));
  const double roll = between(-kMaxRoll, kMaxRoll, spread(number, kRoll));
  const cv::Affine3d facing(cv::Vec3d(CV_PI, 0, 0));  // its y is up, and its z towards the camera
  const cv::Affine3d tilted(cv::Vec3d(tilt * std::cos(axis), tilt * std::sin(axis), 0));
  return (facing * tilted * cv::Affine3d(cv::Vec3d(0, 0, roll))).rotation();
}

struct Interval
{
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
};

// Where the middle may be along x or y so that all points, around it, are seen between two slopes of the rays.
Interval roomFor(const Polygon3& around, double cv::Point3d::*axis, double distance, const Interval& slopes)
{
  Interval room;
  for (const cv::Point3d& p : around)
  {
    room.low = std::max(room.low, slopes.low * (distance + p.z) - p.*axis);
    room.high = std::min(room.high, slopes.high * (distance + p.z) - p.*axis);
  }
  return room;
}

// The slopes of the rays that the picture has along an axis, as if the lens did not bend them; if it bends them
// inwards, there are more.
Interval slopesOf(double middle, double focal, int pixels)
{
  return {-(middle + 0.5) / focal, (pixels - 0.5 - middle) / focal};
}

double placed(const Interval& room, double part)
{
  return between(room.low, room.high, std::clamp(0.5 + kToTheBorder * (part - 0.5), 0.0, 1.0));
}

}  // namespace

cv::Affine3d shownBoard(int view, const cv::Size2d& size, const CameraModel& camera)
{
  const cv::Affine3d turn(turnOf(view));
  const Polygon3 around = corners(turn, size);
  const Interval columns = slopesOf(camera.K(0, 2), camera.K(0, 0), camera.width);
  const Interval rows = slopesOf(camera.K(1, 2), camera.K(1, 1), camera.height);
  const double filling = std::max(size.width / (columns.high - columns.low), size.height / (rows.high - rows.low));
  const double farther = 1.05;
  for (double distance = filling * between(kNearest, kFarthest, spread(view, kDistance));; distance *= farther)
  {
    const Interval x = roomFor(around, &cv::Point3d::x, distance, columns);
    const Interval y = roomFor(around, &cv::Point3d::y, distance, rows);
    if (x.low > x.high || y.low > y.high) continue;
    return cv::Affine3d(turn.rotation(), {placed(x, spread(view, kAcross)), placed(y, spread(view, kDown)), distance});
  }
}

}  // namespace robot_vision::scene
