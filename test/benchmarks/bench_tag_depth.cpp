// Poses of tags by a depth image, ours and as ar_track_alvar publishes them: bench_tag_depth SHOTS
//
// A tag is seen by a camera with a focal length of 525 px and by a Kinect in its place, whose noise is that of the
// synthetic scene; a bias of 5 mm is that of each image. Corners have noise as libapriltag and as measureCorners()
// leave it. Theirs is done as their individualMarkers is documented to do it with a Kinect: the plane of the points
// inside of the tag by RANSAC (10 mm), the position as the centroid of its inliers, the axes from the points of the
// four corners on that plane. Ours is with the corners alone, and with corners and depth. All see the same images, in
// turns. Prints JSON: for each tag, distance, tilt and noise of corners the root mean square errors of tilt (degrees)
// and distance (mm), the share of poses that are tilted to the wrong side or are none at all, and the median time (us).

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <vector>

#include "measure.hpp"
#include "robot_vision/scene/depth_noise.hpp"
#include "robot_vision/tags/pose/tag_plane.hpp"
#include "robot_vision/tags/pose/tag_pose.hpp"

namespace
{

using robot_vision::CameraModel;

constexpr double kFocus = 525.0;         // px
constexpr double kBias = 0.005;          // m
constexpr double kDegree = CV_PI / 180;  // rad
constexpr int kRansacRounds = 50;
constexpr double kRansacDistance = 0.01;  // m

/// Size (m), distance (m) and tilt (degrees).
constexpr std::array<double, 3> kTags[] = {
    {0.1, 1.0, 5.0}, {0.1, 2.0, 5.0}, {0.1, 1.0, 40.0}, {0.24, 2.0, 40.0}, {0.02, 1.05, 35.0},
};

struct Case
{
  double size, distance, tilt, noise;  // m, m, degrees, px
};

/// What is seen in one image.
struct Shot
{
  cv::Affine3d truth;
  robot_vision::TagCorners corners;
  cv::Mat depth;  // m
};

CameraModel cameraFor(const Case& of)
{
  const int side = cvCeil(1.5 * kFocus * of.size / of.distance) + 16;
  const double middle = (side - 1) / 2.0;
  return {side, side, {kFocus, 0.0, middle, 0.0, kFocus, middle, 0.0, 0.0, 1.0}, {}};
}

Shot shoot(const Case& of, const CameraModel& camera, const robot_vision::DepthNoise& noise, int number,
           cv::RNG& random)
{
  const double side = random.uniform(0.0, 2.0 * CV_PI);
  const cv::Affine3d turn(cv::Vec3d(std::cos(side), std::sin(side), 0.0) * (of.tilt * kDegree));
  const cv::Affine3d spin(cv::Vec3d(0.0, 0.0, random.uniform(0.0, 2.0 * CV_PI)));
  const cv::Matx33d facing(1, 0, 0, 0, -1, 0, 0, 0, -1);
  Shot shot;
  shot.truth = {turn.rotation() * facing * spin.rotation(), cv::Vec3d(0.0, 0.0, of.distance)};
  const double half = of.size / 2.0;
  const std::array<cv::Point3d, 4> points = {
      cv::Point3d(-half, -half, 0), {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  for (std::size_t i = 0; i < 4; ++i)
    shot.corners.corners[i] =
        camera.project(shot.truth * points[i]) + cv::Point2d(random.gaussian(of.noise), random.gaussian(of.noise));
  const cv::Vec3d normal = shot.truth.rotation() * cv::Vec3d(0, 0, 1);
  const double distance = normal.dot(shot.truth.translation());
  cv::Mat exact(camera.height, camera.width, CV_32FC1);
  for (int y = 0; y < exact.rows; ++y)
    for (int x = 0; x < exact.cols; ++x)
    {
      const cv::Point2d ray = camera.ray(cv::Point2d(x, y));
      exact.at<float>(y, x) = static_cast<float>(distance / normal.dot(cv::Vec3d(ray.x, ray.y, 1.0)));
    }
  noise.apply(number, exact, cv::Mat(), shot.depth);
  shot.depth += random.gaussian(kBias);
  return shot;
}

std::optional<cv::Vec3d> pointAt(const Shot& shot, const cv::Point& pixel, const CameraModel& camera)
{
  if (!cv::Rect(cv::Point(), shot.depth.size()).contains(pixel)) return std::nullopt;
  const double z = static_cast<double>(shot.depth.at<float>(pixel));
  if (!std::isfinite(z)) return std::nullopt;
  const cv::Point2d ray = camera.ray(cv::Point2d(pixel));
  return cv::Vec3d(ray.x * z, ray.y * z, z);
}

struct Plane
{
  cv::Vec3d normal;
  double distance = 0.0;  // m
  std::vector<cv::Vec3d> inliers;
};

/// The plane with the most points near it, of three random ones; then the least squares of these.
Plane ransac(const std::vector<cv::Vec3d>& points, cv::RNG& random)
{
  Plane best;
  const int count = static_cast<int>(points.size());
  const auto any = [&] { return points[static_cast<std::size_t>(random.uniform(0, count))]; };
  for (int round = 0; round < kRansacRounds; ++round)
  {
    const cv::Vec3d a = any();
    Plane plane;
    plane.normal = (any() - a).cross(any() - a);
    if (cv::norm(plane.normal) < 1e-12) continue;
    plane.normal = cv::normalize(plane.normal);
    plane.distance = plane.normal.dot(a);
    for (const cv::Vec3d& point : points)
      if (std::abs(plane.normal.dot(point) - plane.distance) < kRansacDistance) plane.inliers.push_back(point);
    if (plane.inliers.size() > best.inliers.size()) std::swap(plane, best);
  }
  if (best.inliers.size() < 3) return best;
  cv::Vec3d middle;
  for (const cv::Vec3d& point : best.inliers)
    middle += point * (1.0 / static_cast<double>(best.inliers.size()));
  cv::Matx33d scatter = cv::Matx33d::zeros();
  for (const cv::Vec3d& point : best.inliers)
    scatter += (point - middle) * (point - middle).t();
  cv::Vec3d values;
  cv::Matx33d vectors;
  cv::eigen(scatter, values, vectors);
  best.normal = cv::Vec3d(vectors(2, 0), vectors(2, 1), vectors(2, 2));
  best.distance = best.normal.dot(middle);
  return best;
}

/// Position and axes from points alone, with the corners only to say which points.
std::optional<cv::Affine3d> fromPoints(const Shot& shot, const CameraModel& camera, cv::RNG& random)
{
  std::vector<cv::Point2f> outline;
  for (const cv::Point2d& corner : shot.corners.corners)
    outline.emplace_back(corner);
  const cv::Rect box = cv::boundingRect(outline);
  std::vector<cv::Vec3d> points;
  for (int y = box.y; y < box.br().y; ++y)
    for (int x = box.x; x < box.br().x; ++x)
      if (cv::pointPolygonTest(outline, cv::Point2f(cv::Point(x, y)), false) >= 0)
        if (const auto point = pointAt(shot, {x, y}, camera)) points.push_back(*point);
  if (points.size() < 3) return std::nullopt;
  const Plane plane = ransac(points, random);
  if (plane.inliers.size() < 3) return std::nullopt;
  cv::Vec3d middle;
  for (const cv::Vec3d& point : plane.inliers)
    middle += point * (1.0 / static_cast<double>(plane.inliers.size()));
  std::array<cv::Vec3d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i)
  {
    const auto point = pointAt(shot, cv::Point(shot.corners.corners[i]), camera);
    if (!point) return std::nullopt;
    corners[i] = *point - plane.normal * (plane.normal.dot(*point) - plane.distance);
  }
  if (cv::norm(corners[1] - corners[0]) < 1e-3) return std::nullopt;
  const cv::Vec3d x = cv::normalize(corners[1] - corners[0]);
  cv::Vec3d z = plane.normal, y = z.cross(x);
  if (y.dot(corners[3] - corners[0]) < 0.0)
  {
    y = -y;
    z = -z;
  }
  return cv::Affine3d(cv::Matx33d(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]), middle);
}

/// What one of the ways finds in all images of a case.
class Contender
{
public:
  using Find = std::function<std::optional<cv::Affine3d>(const Shot&)>;

  Contender(const char* name, Find find) : name_(name), find_(std::move(find)) {}

  void see(const Shot& shot, double tilt)
  {
    const double begin = bench::seconds(CLOCK_THREAD_CPUTIME_ID);
    const std::optional<cv::Affine3d> found = find_(shot);
    times_.push_back((bench::seconds(CLOCK_THREAD_CPUTIME_ID) - begin) * 1e6);
    if (!found)
    {
      ++wrong_;
      return;
    }
    const cv::Vec3d out(0, 0, 1), normal = found->rotation() * out, truth = shot.truth.rotation() * out;
    const double angle = std::acos(std::clamp(normal.dot(truth), -1.0, 1.0)) / kDegree;
    wrong_ += angle > std::max(tilt, 20.0);  // the other one of the two poses is twice the tilt away
    tilts_ += angle * angle;
    distances_ += std::pow((found->translation()[2] - shot.truth.translation()[2]) * 1e3, 2);
    ++found_;
  }

  void print() const
  {
    const double count = std::max(found_, 1);
    std::printf("\"%s\": {\"tilt\": %.4f, \"distance\": %.4f, \"wrong\": %.6f, \"us\": %.2f}", name_,
                std::sqrt(tilts_ / count), std::sqrt(distances_ / count), wrong_ / static_cast<double>(times_.size()),
                bench::median(times_));
  }

private:
  const char* name_;
  Find find_;
  std::vector<double> times_;             // us
  double tilts_ = 0.0, distances_ = 0.0;  // sums of squares, degrees^2 and mm^2
  int found_ = 0, wrong_ = 0;
};

std::optional<cv::Affine3d> poseOf(const Case& of, const robot_vision::TagCorners& corners, const CameraModel& camera)
{
  const auto poses = robot_vision::estimatePose(robot_vision::singleTag(0, of.size), {corners}, camera, of.noise, 0.0);
  return poses ? std::optional<cv::Affine3d>(poses->best.pose) : std::nullopt;
}

void measure(const Case& of, int shots)
{
  const CameraModel camera = cameraFor(of);
  const robot_vision::DepthNoise noise(robot_vision::DepthSensor::kKinect, camera, 1);
  cv::RNG random(1), sampling(2);
  const auto both = [&](const Shot& shot)
  {
    robot_vision::TagCorners corners = shot.corners;
    corners.plane = robot_vision::measureTagPlane(shot.depth, corners.corners, camera);
    return poseOf(of, corners, camera);
  };
  Contender contenders[] = {
      {"points", [&](const Shot& shot) { return fromPoints(shot, camera, sampling); }},
      {"corners", [&](const Shot& shot) { return poseOf(of, shot.corners, camera); }},
      {"both", both},
  };
  for (int number = 0; number < shots; ++number)
  {
    const Shot shot = shoot(of, camera, noise, number, random);
    for (Contender& contender : contenders)
      contender.see(shot, of.tilt);
  }
  std::printf("{\"size\": %g, \"distance\": %g, \"tilt\": %g, \"noise\": %g", of.size, of.distance, of.tilt, of.noise);
  for (const Contender& contender : contenders)
  {
    std::printf(", ");
    contender.print();
  }
  std::printf("}");
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc != 2) throw std::invalid_argument("bench_tag_depth SHOTS");
  cv::setNumThreads(1);
  const char* comma = "[";
  for (const double noise : {0.3, 0.03})
    for (const auto& [size, distance, tilt] : kTags)
    {
      std::printf("%s", comma);
      measure({size, distance, tilt, noise}, std::max(std::atoi(argv[1]), 1));
      comma = ", ";
    }
  std::printf("]\n");
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_tag_depth: %s\n", e.what());
  return 1;
}
