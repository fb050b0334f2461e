#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "depth_frames.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/depth/tabletop.hpp"
#include "robot_vision/scene/depth_noise.hpp"

namespace bench
{
namespace
{

using robot_vision::CameraModel;

constexpr std::size_t kFrames = 4;
constexpr int kObjects = 4;
constexpr double kPitch = 0.6;  // rad, by which the camera looks down

/// A table with three boxes and a ball before a wall, measured by a Kinect, 16UC1.
cv::Mat kitchen(std::size_t number)
{
  const CameraModel kinect = depthCamera(kDepthSize);
  const cv::Vec3d right(1.0, 0.0, 0.0), away(0.0, -std::sin(kPitch), std::cos(kPitch));
  const cv::Vec3d up(0.0, -std::cos(kPitch), -std::sin(kPitch));
  const cv::Vec3d table(0.002 * static_cast<double>(number), 0.05, 1.1);
  DepthWorld world;
  world.rectangles = {{table, 0.7 * right, 0.5 * away}, {table + 1.2 * away, 3.0 * right, 3.0 * up}};
  for (int i = 0; i < 3; ++i)
  {
    const double half = 0.06, height = 0.05 + 0.02 * i;  // the half of it
    const cv::Vec3d middle = table + (0.22 * i - 0.35) * right - 0.05 * away + height * up;
    world.rectangles.push_back({middle + height * up, half * right, half * away});
    world.rectangles.push_back({middle - half * away, half * right, height * up});
    world.rectangles.push_back({middle + half * right, half * away, height * up});
    world.rectangles.push_back({middle - half * right, half * away, height * up});
  }
  world.spheres = {{table + 0.35 * right + 0.1 * away + 0.06 * up, 0.06}};
  cv::Mat measured, depth;
  robot_vision::DepthNoise(robot_vision::DepthSensor::kKinect, kinect, 5)
      .apply(static_cast<int>(number), world.depth(kinect), cv::Mat(), measured);
  robot_vision::toMillimetres(measured, "32FC1", depth);
  return depth;
}

/// x, y, z (m) of each pixel; 0 where there is no depth.
void toPoints(const cv::Mat& depth, const CameraModel& camera, cv::Mat& points)
{
  points.create(depth.size(), CV_32FC3);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
    {
      const double z = depth.at<std::uint16_t>(v, u) * 0.001;
      const cv::Vec3d point((u - camera.K(0, 2)) / camera.K(0, 0) * z, (v - camera.K(1, 2)) / camera.K(1, 1) * z, z);
      points.at<cv::Vec3f>(v, u) = point;
    }
}

/// Tables as they are usually found: the plane that most of the points are on, of many through three random ones, and
/// the parts of the image that are above its hull.
class PlainTabletop
{
public:
  int objects = 0;
  cv::Vec4d plane;  // normal, to the camera, and distance

  void apply(const cv::Mat& depth, const CameraModel& camera)
  {
    toPoints(depth, camera, points_);
    some_.clear();
    for (int v = 4; v < points_.rows; v += 8)
      for (int u = 4; u < points_.cols; u += 8)
        if (points_.at<cv::Vec3f>(v, u)[2] > 0.0F) some_.push_back(points_.at<cv::Vec3f>(v, u));
    plane = fitted(inliers(best()));
    const cv::Matx23d axes = along();
    std::vector<cv::Point2f> places, hull;
    for (const cv::Vec3d& point : inliers(plane))
      places.emplace_back(cv::Vec2f(axes * point));
    cv::convexHull(places, hull);
    mask_.create(depth.size(), CV_8UC1);
    for (int v = 0; v < mask_.rows; ++v)
      for (int u = 0; u < mask_.cols; ++u)
      {
        const cv::Vec3d point = points_.at<cv::Vec3f>(v, u);
        const double above = height(plane, point);
        const bool high = point[2] > 0.0 && above > 0.02 && above < 0.6;
        mask_.at<std::uint8_t>(v, u) =
            high && cv::pointPolygonTest(hull, cv::Point2f(cv::Vec2f(axes * point)), false) >= 0.0 ? 255 : 0;
      }
    count();
  }

private:
  static constexpr int kTries = 100;

  static double height(const cv::Vec4d& plane, const cv::Vec3d& point)
  {
    return plane[0] * point[0] + plane[1] * point[1] + plane[2] * point[2] + plane[3];
  }

  static cv::Vec4d facing(const cv::Vec3d& normal, const cv::Vec3d& on)
  {
    const cv::Vec3d to = normal.dot(on) > 0.0 ? -normal : normal;
    return {to[0], to[1], to[2], -to.dot(on)};
  }

  std::vector<cv::Vec3d> inliers(const cv::Vec4d& of) const
  {
    std::vector<cv::Vec3d> found;
    for (const cv::Vec3d& point : some_)
      if (std::abs(height(of, point)) < 0.01) found.push_back(point);
    return found;
  }

  cv::Vec4d best() const
  {
    cv::RNG random(1);
    cv::Vec4d result;
    std::size_t most = 0;
    const auto any = [&] { return some_[static_cast<std::size_t>(random.uniform(0, static_cast<int>(some_.size())))]; };
    for (int i = 0; i < kTries; ++i)
    {
      const cv::Vec3d on = any(), normal = (any() - on).cross(any() - on);
      if (cv::norm(normal) < 1e-9) continue;
      const cv::Vec4d tried = facing(cv::normalize(normal), on);
      const std::size_t count = inliers(tried).size();
      if (count > most) result = tried;
      most = std::max(most, count);
    }
    return result;
  }

  static cv::Vec4d fitted(const std::vector<cv::Vec3d>& points)
  {
    const cv::PCA axes(cv::Mat(points).reshape(1), cv::Mat(), cv::PCA::DATA_AS_ROW);
    return facing(axes.eigenvectors.row(2).reshape(3).at<cv::Vec3d>(0), axes.mean.reshape(3).at<cv::Vec3d>(0));
  }

  cv::Matx23d along() const
  {
    const cv::Vec3d normal(plane[0], plane[1], plane[2]), x = cv::normalize(cv::Vec3d(1, 0, 0).cross(normal));
    const cv::Vec3d y = normal.cross(x);
    return {x[0], x[1], x[2], y[0], y[1], y[2]};
  }

  void count()
  {
    const int found = cv::connectedComponentsWithStats(mask_, labels_, stats_, middles_);
    objects = 0;
    for (int i = 1; i < found; ++i)
      objects += stats_.at<int>(i, cv::CC_STAT_AREA) >= 100 ? 1 : 0;
  }

  std::vector<cv::Vec3d> some_;
  cv::Mat points_, mask_, labels_, stats_, middles_;
};

struct TabletopState
{
  explicit TabletopState(const Setup& setup) : camera(depthCamera(setup.frames.front().size())), finder(camera)
  {
    for (std::size_t i = 0; i < kFrames; ++i)
      frames.push_back(enlarged(kitchen(i), setup.frames.front().size()));
  }

  void byOpenCv(std::size_t i) { theirs.apply(frames[i % kFrames], camera); }
  void byUs(std::size_t i) { ours = finder.find(frames[i % kFrames], "16UC1"); }

  /// Both have all objects, and the same plane.
  bool same() const
  {
    if (ours.tables.size() != 1 || theirs.objects < kObjects) return false;
    const robot_vision::Table& table = ours.tables[0];
    const cv::Vec3d normal(theirs.plane[0], theirs.plane[1], theirs.plane[2]);
    return table.objects.size() == kObjects && table.plane.normal.dot(normal) > 0.999 &&
           std::abs(table.plane.distance - theirs.plane[3]) < 0.01;
  }

  CameraModel camera;
  std::vector<cv::Mat> frames;
  PlainTabletop theirs;
  robot_vision::TabletopFinder finder;
  robot_vision::Tabletop ours;
};

}  // namespace

std::vector<Work> tabletopWorks()
{
  return {{"a table and what stands on it", "RANSAC, convexHull, connectedComponentsWithStats", 2.0,
           contestOf<TabletopState>()}};
}

}  // namespace bench
