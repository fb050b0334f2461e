#include "scene_model.hpp"

#include <algorithm>
#include <cmath>

#include "robot_vision/scene/scene.hpp"

namespace robot_vision::scene
{

namespace
{

const double kFrontX = -1.0, kBackWallX = 2.7;                                  // m; the room begins behind the camera
const double kHalfRoomWidth = 1.75, kRoomHeight = 2.4, kSkirtingHeight = 0.08;  // m

cv::Affine3d poseFromAxes(const cv::Vec3d& right, const cv::Vec3d& up, const cv::Vec3d& origin)
{
  const cv::Vec3d out = right.cross(up);
  const cv::Matx33d axes(right[0], up[0], out[0], right[1], up[1], out[1], right[2], up[2], out[2]);
  return cv::Affine3d(axes, origin);
}

// The pose of an upright board that faces the camera's mean position, turned to the viewer's left and then tilted back
// by the given angles in radians.
cv::Affine3d facing(const cv::Vec3d& origin, double turn = 0.0, double tilt = 0.0)
{
  const cv::Affine3d upright = poseFromAxes({0, -1, 0}, {0, 0, 1}, origin);
  return upright * cv::Affine3d(cv::Vec3d(0, turn, 0)) * cv::Affine3d(cv::Vec3d(-tilt, 0, 0));
}

// A rectangle parallel to a board; `offset` moves its middle right, up and out of the board's plane.
Board inPlaneOf(const Board& board, const cv::Vec3d& offset, const cv::Size2d& size)
{
  return {board.pose * cv::Affine3d(cv::Matx33d::eye(), offset), size};
}

double smoothStep(double t)
{
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

}  // namespace

Room buildRoom()
{
  const double extra = 0.2, length = kBackWallX - kFrontX, middle = (kBackWallX + kFrontX) / 2.0;
  Room r;
  r.floor = {poseFromAxes({0, -1, 0}, {1, 0, 0}, {middle + extra / 2.0, 0, 0}),
             {2.0 * (kHalfRoomWidth + extra), length + extra}};
  r.ceiling = {poseFromAxes({0, -1, 0}, {-1, 0, 0}, {middle + extra / 2.0, 0, kRoomHeight}), r.floor.size};
  r.back_wall = {facing({kBackWallX, 0, kRoomHeight / 2.0}), {2.0 * (kHalfRoomWidth + extra), kRoomHeight}};
  r.left_wall = {poseFromAxes({1, 0, 0}, {0, 0, 1}, {middle, kHalfRoomWidth, kRoomHeight / 2.0}),
                 {length, kRoomHeight}};
  r.right_wall = {poseFromAxes({-1, 0, 0}, {0, 0, 1}, {middle, -kHalfRoomWidth, kRoomHeight / 2.0}),
                  {length, kRoomHeight}};
  const double down = (kSkirtingHeight - kRoomHeight) / 2.0, thickness = 0.004;
  r.skirting = {inPlaneOf(r.back_wall, {0, down, thickness}, {2.0 * kHalfRoomWidth, kSkirtingHeight}),
                inPlaneOf(r.left_wall, {0, down, thickness}, {length, kSkirtingHeight}),
                inPlaneOf(r.right_wall, {0, down, thickness}, {length, kSkirtingHeight})};
  return r;
}

Board tagBoard(int id)
{
  const double side = kSceneTagSide * 10.0 / 8.0;
  if (id == 0) return {facing({kBackWallX - 0.01, -0.33, 0.60}), {side, side}};
  return {facing({2.1, -0.94, 0.155}, -0.38, 0.26), {side, side}};
}

Board qrBoard()
{
  const double side = kSceneQrSide * 27.0 / 21.0;
  return {facing({kBackWallX - 0.01, -0.95, 1.05}), {side, side}};
}

Board checkerBoard()
{
  return {facing({kBackWallX - 0.01, -0.33, 1.10}), {10.0 * kSceneCheckerSquare, 8.0 * kSceneCheckerSquare}};
}

Board posterBoard(double aspect)
{
  const double longer = 1.1;
  const cv::Size2d size = aspect > 1.0 ? cv::Size2d(longer, longer / aspect) : cv::Size2d(longer * aspect, longer);
  return {facing({kBackWallX - 0.02, 0.72, 0.82}), size};
}

double lineCenter(double forward)
{
  return kLineCurve[0] + forward * (kLineCurve[1] + forward * kLineCurve[2]);
}

cv::Affine3d linePose()
{
  const double forward = (kLineBegin + kLineEnd) / 2.0;
  return poseFromAxes({0, -1, 0}, {1, 0, 0}, {forward, lineCenter(forward), 0});
}

double sceneTime(long long frame, double rate)
{
  const double seconds = std::fmod(static_cast<double>(frame) / rate, kScenePeriod);
  return seconds < 0.0 ? seconds + kScenePeriod : seconds;
}

cv::Affine3d lookingAt(const cv::Vec3d& eye, const cv::Vec3d& target, double roll)
{
  const cv::Vec3d forward = cv::normalize(target - eye);
  const cv::Vec3d right = cv::normalize(forward.cross(cv::Vec3d(0, std::sin(roll), std::cos(roll))));
  return poseFromAxes(right, forward.cross(right), eye);
}

cv::Affine3d cameraPose(double seconds)
{
  const double phase = 2.0 * CV_PI * seconds / kScenePeriod;
  const cv::Vec3d eye(0.09 * std::sin(phase), 0.20 * std::cos(phase), 0.80 + 0.05 * std::sin(2.0 * phase));
  const cv::Vec3d target(kBackWallX, 0.10 * std::sin(phase + 1.0), 0.44 + 0.04 * std::cos(2.0 * phase));
  return lookingAt(eye, target, 0.02 * std::sin(phase + 2.0));
}

cv::Point3d ballCenter(double seconds)
{
  const double round_trip = 10.0, bounce_time = 1.25, bounce_height = 0.42;
  const double phase = 2.0 * CV_PI * seconds / round_trip;
  const double t = seconds / bounce_time - std::floor(seconds / bounce_time);
  const double lift = 4.0 * bounce_height * t * (1.0 - t);
  return {1.75 + 0.15 * std::cos(phase), 0.80 * std::sin(phase), kSceneBallRadius + lift};
}

cv::Affine3d boxPose(double seconds)
{
  const double rest = 7.0, slide = 3.0;
  const double there = smoothStep((seconds - rest) / slide) - smoothStep((seconds - slide - 2.0 * rest) / slide);
  return facing({2.12, 0.90 - 0.4 * there, kBoxSize[1] / 2.0}, -0.35 + 0.5 * there);
}

Board onFloor(double forward, double left, const cv::Size2d& size, double height)
{
  return {poseFromAxes({0, -1, 0}, {1, 0, 0}, {forward, left, height}), size};
}

Board upright(const cv::Vec3d& middle, double turn, const cv::Size2d& size)
{
  return {facing(middle, turn), size};
}

}  // namespace robot_vision::scene
