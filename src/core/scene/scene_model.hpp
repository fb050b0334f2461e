#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

// Where everything is, in the world: x forward, y left, z up, metres; the origin on the floor below the camera's mean
// position. Poses of planar things: x right and y up for a viewer in front, z out of the face, origin in the middle.
namespace robot_vision::scene
{

/// A flat rectangle: a pose and its full width and height.
struct Board
{
  cv::Affine3d pose;
  cv::Size2d size;
};

/// The room as the camera can see it. The back wall and the floor run on behind the side walls, so that no gap shows.
struct Room
{
  Board floor, ceiling, back_wall, left_wall, right_wall;
  std::array<Board, 3> skirting;
};

const Room& room();

/// Boards that never move. `board` is the whole board with its white margin.
Board tagBoard(int id);
Board qrBoard();
Board checkerBoard();
/// The picture on the wall; `aspect` is its width over its height.
Board posterBoard(double aspect);

/// The line on the floor lies where |left - lineCenter(forward)| <= half its width, from kLineBegin to kLineEnd.
constexpr double kLineBegin = 0.5, kLineEnd = 2.45;                // m forward
constexpr std::array<double, 3> kLineCurve = {0.14, -0.52, 0.24};  // m left: c0 + c1 forward + c2 forward^2
double lineCenter(double forward);
/// x right, y forward, z up, origin on the middle of the line.
cv::Affine3d linePose();

/// Width (right), height and depth of the box.
const cv::Vec3d kBoxSize(0.34, 0.28, 0.28);

/// Seconds into the motion, 0 to its period, also for negative frames. `rate` in Hz.
double sceneTime(long long frame, double rate);

cv::Affine3d cameraPose(double seconds);
cv::Point3d ballCenter(double seconds);
/// Rests for seven seconds, then slides for three.
cv::Affine3d boxPose(double seconds);

/// A rectangle lying on the floor, for shadows.
Board onFloor(double forward, double left, const cv::Size2d& size);

/// A rectangle parallel to a board, its middle moved right, up and out of the board's plane.
Board inPlaneOf(const Board& board, const cv::Vec3d& offset, const cv::Size2d& size);

}  // namespace robot_vision::scene
