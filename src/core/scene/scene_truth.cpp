#include "scene_truth.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace robot_vision::scene
{

namespace
{

// An object with what decides whether it is visible.
struct Projected
{
  SceneObject object;
  Polygon2 extent;  // all that it covers, including the margin of a board, px
  double distance;  // from the camera to its middle, m
  bool faces_camera;
};

Projected projected(const std::string& name, const cv::Affine3d& pose, const CameraModel& camera)
{
  Projected result;
  result.object.name = name;
  result.object.pose = pose;
  result.object.center = camera.project(cv::Point3d(pose.translation()));
  result.distance = cv::norm(pose.translation());
  result.faces_camera = true;
  return result;
}

// `marked` (m) is the size of the part of the board that the outline goes around.
Projected projectedBoard(const std::string& name, const Board& board, const cv::Size2d& marked,
                         const cv::Affine3d& world_in_camera, const CameraModel& camera)
{
  const int edge_pieces = 8;
  Projected result = projected(name, world_in_camera * board.pose, camera);
  result.object.outline = project(corners(result.object.pose, marked), camera, 1);
  result.extent = project(corners(result.object.pose, board.size), camera, edge_pieces);
  result.faces_camera = facesCamera(result.object.pose);
  return result;
}

Projected projectedBall(double seconds, const cv::Affine3d& world_in_camera, const CameraModel& camera)
{
  const int points = 64;
  const cv::Point3d center = ballCenter(seconds);
  const cv::Affine3d in_world(cv::Matx33d::eye(), cv::Vec3d(center));
  Projected result = projected("ball", world_in_camera * in_world, camera);
  result.extent = ballOutline(camera, world_in_camera * center, kSceneBallRadius, points);
  result.object.outline = result.extent;
  return result;
}

Projected projectedBox(double seconds, const cv::Affine3d& world_in_camera, const CameraModel& camera)
{
  Projected result = projected("box", world_in_camera * boxPose(seconds), camera);
  std::vector<cv::Point2f> points, hull;
  for (int corner = 0; corner < 8; ++corner)
  {
    const cv::Vec3d sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
    points.emplace_back(camera.project(result.object.pose * cv::Point3d(kBoxSize.mul(sign))));
  }
  cv::convexHull(points, hull);
  result.extent.assign(hull.begin(), hull.end());
  result.object.outline = result.extent;
  return result;
}

Projected projectedLine(const cv::Affine3d& world_in_camera, const Lens& lens)
{
  Projected result = projected("line", world_in_camera * linePose(), lens.camera);
  const Polygon3 in_view = clipToView(lineOutline(world_in_camera), lens);
  result.extent = clipToImage(project(in_view, lens.camera, 1), lens.camera);
  result.object.outline = result.extent;
  return result;
}

bool isVisible(const Projected& one, const std::vector<Projected>& all, const CameraModel& camera)
{
  if (!one.faces_camera || !insideImage(one.object.outline, camera)) return false;
  return std::none_of(all.begin(), all.end(),
                      [&](const Projected& other)
                      {
                        // The line lies flat on the floor: it covers nothing, and everything covers it.
                        const bool nearer = one.object.name == "line" || other.distance < one.distance;
                        return &other != &one && other.object.name != "line" && nearer &&
                               overlap(one.extent, other.extent);
                      });
}

}  // namespace

SceneTruth truthAt(double seconds, const cv::Affine3d& pose, double poster_aspect, const Lens& lens)
{
  const CameraModel& camera = lens.camera;
  const double qr = kSceneQrSide, tag = kSceneTagSide, square = kSceneCheckerSquare;
  SceneTruth truth;
  truth.camera = pose;
  const cv::Affine3d world = pose.inv();
  const Board poster = posterBoard(poster_aspect);
  const std::vector<Projected> all = {
      projectedBall(seconds, world, camera),
      projectedBoard("tag_0", tagBoard(0), {tag, tag}, world, camera),
      projectedBoard("tag_1", tagBoard(1), {tag, tag}, world, camera),
      projectedBoard("qr_code", qrBoard(), {qr, qr}, world, camera),
      projectedBoard("checkerboard", checkerBoard(), {7 * square, 5 * square}, world, camera),
      projectedLine(world, lens),
      projectedBox(seconds, world, camera),
      projectedBoard("poster", poster, poster.size, world, camera)};
  for (const Projected& one : all)
  {
    truth.objects.push_back(one.object);
    truth.objects.back().visible = isVisible(one, all, camera);
  }
  return truth;
}

}  // namespace robot_vision::scene
