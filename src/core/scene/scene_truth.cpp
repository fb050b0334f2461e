#include "scene_truth.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace robot_vision::scene
{

namespace
{

// What visibility needs to know of an object besides its outline.
struct Seen
{
  SceneObject object;
  Polygon2 extent;  // all it covers, a board with its margin
  double distance;  // of its middle, m
  bool faces;       // the camera
};

Seen seen(const std::string& name, const cv::Affine3d& pose, const CameraModel& camera)
{
  Seen result;
  result.object.name = name;
  result.object.pose = pose;
  result.object.center = camera.project(cv::Point3d(pose.translation()));
  result.distance = cv::norm(pose.translation());
  result.faces = true;
  return result;
}

// `marked` is the part of the board that the outline goes around.
Seen seenBoard(const std::string& name, const Board& board, const cv::Size2d& marked,
               const cv::Affine3d& world_in_camera, const CameraModel& camera)
{
  const int edge_pieces = 8;
  Seen result = seen(name, world_in_camera * board.pose, camera);
  result.object.outline = project(corners(result.object.pose, marked), camera, 1);
  result.extent = project(corners(result.object.pose, board.size), camera, edge_pieces);
  result.faces = facesCamera(result.object.pose);
  return result;
}

Seen seenBall(double seconds, const cv::Affine3d& world_in_camera, const CameraModel& camera)
{
  const int points = 64;
  const cv::Point3d center = ballCenter(seconds);
  const cv::Affine3d in_world(cv::Matx33d::eye(), cv::Vec3d(center));
  Seen result = seen("ball", world_in_camera * in_world, camera);
  result.extent = ballOutline(camera, world_in_camera * center, kSceneBallRadius, points);
  result.object.outline = result.extent;
  return result;
}

Seen seenBox(double seconds, const cv::Affine3d& world_in_camera, const CameraModel& camera)
{
  Seen result = seen("box", world_in_camera * boxPose(seconds), camera);
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

Seen seenLine(const cv::Affine3d& world_in_camera, const Lens& lens)
{
  Seen result = seen("line", world_in_camera * linePose(), lens.camera);
  const Polygon3 in_view = clipToView(lineOutline(world_in_camera), lens);
  result.extent = clipToPicture(project(in_view, lens.camera, 1), lens.camera);
  result.object.outline = result.extent;
  return result;
}

bool insidePicture(const Polygon2& outline, const CameraModel& camera)
{
  return !outline.empty() &&
         std::all_of(outline.begin(), outline.end(),
                     [&](const cv::Point2d& p)
                     { return p.x >= -0.5 && p.y >= -0.5 && p.x <= camera.width - 0.5 && p.y <= camera.height - 0.5; });
}

bool isVisible(const Seen& one, const std::vector<Seen>& all, const CameraModel& camera)
{
  if (!one.faces || !insidePicture(one.object.outline, camera)) return false;
  return std::none_of(all.begin(), all.end(),
                      [&](const Seen& other)
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
  const std::vector<Seen> all = {seenBall(seconds, world, camera),
                                 seenBoard("tag_0", tagBoard(0), {tag, tag}, world, camera),
                                 seenBoard("tag_1", tagBoard(1), {tag, tag}, world, camera),
                                 seenBoard("qr_code", qrBoard(), {qr, qr}, world, camera),
                                 seenBoard("checkerboard", checkerBoard(), {7 * square, 5 * square}, world, camera),
                                 seenLine(world, lens),
                                 seenBox(seconds, world, camera),
                                 seenBoard("poster", poster, poster.size, world, camera)};
  for (const Seen& one : all)
  {
    truth.objects.push_back(one.object);
    truth.objects.back().visible = isVisible(one, all, camera);
  }
  return truth;
}

}  // namespace robot_vision::scene
