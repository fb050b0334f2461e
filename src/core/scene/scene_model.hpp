#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

// The poses of all objects in the world frame: x forward, y left, z up, in metres, the origin on the floor below the
// camera's mean position. Planar objects have x right and y up for a viewer in front, z out of the face, and their
// origin in the middle.
namespace robot_vision::scene
{

/// A flat rectangle: its pose, and its full width and height in metres.
struct Board
{
  cv::Affine3d pose;
  cv::Size2d size;
};

/// The parts of the room that the camera can see. Floor and back wall go on behind the side walls, so that no gap
/// shows.
struct Room
{
  Board floor, ceiling, back_wall, left_wall, right_wall;
  std::array<Board, 3> skirting;
};

Room buildRoom();

/// The boards that never move, each with its white margin.
Board tagBoard(int id);
Board qrBoard();
Board checkerBoard();
/// The poster on the wall; `aspect` is its width over its height.
Board posterBoard(double aspect);

/// The line covers the floor where |left - lineCenter(forward)| <= half its width, from kLineBegin to kLineEnd.
constexpr double kLineBegin = 0.5, kLineEnd = 2.45;                // m forward
constexpr std::array<double, 3> kLineCurve = {0.14, -0.52, 0.24};  // m left: c0 + c1 forward + c2 forward^2
double lineCenter(double forward);
/// The pose of the line: x right, y forward, z up, origin in its middle.
cv::Affine3d linePose();

/// Width (right), height and depth of the box.
const cv::Vec3d kBoxSize(0.34, 0.28, 0.28);

/// The time of a frame in the periodic motion: 0 to kScenePeriod seconds, also for negative frames. `rate` is in Hz.
double sceneTime(long long frame, double rate);

/// The optical frame of a camera that looks from one point to another; `roll` (rad) turns it to the right.
cv::Affine3d lookingAt(const cv::Vec3d& eye, const cv::Vec3d& target, double roll = 0.0);

cv::Affine3d cameraPose(double seconds);
cv::Point3d ballCenter(double seconds);
/// The box rests for seven seconds, then slides for three.
cv::Affine3d boxPose(double seconds);

/// A rectangle that lies on the floor, or at a height above it.
Board onFloor(double forward, double left, const cv::Size2d& size, double height = 0.0);

/// An upright rectangle. It faces the camera's mean position if `turn` (rad) is 0, and turns to the right of who looks
/// at it from there.
Board upright(const cv::Vec3d& middle, double turn, const cv::Size2d& size);

}  // namespace robot_vision::scene
