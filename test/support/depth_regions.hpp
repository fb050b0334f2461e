#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "depth_world.hpp"
#include "robot_vision/depth/region_depth.hpp"

namespace depth_regions
{

using namespace robot_vision;

inline const WorldRectangle kWall = {{0.0, 0.0, 3.0}, {6.0, 0.0, 0.3}, {0.0, 6.0, 0.0}};
inline const cv::Vec3d kFace(0.15, -0.1, 1.6);  // its middle, of a width of 0.16 m and a height of 0.22 m

/// A face before a wall, and what else there is.
inline DepthWorld faceBeforeAWall(const std::vector<WorldRectangle>& others = {})
{
  DepthWorld world;
  world.rectangles = {kWall, {kFace, {0.08, 0.0, 0.0}, {0.0, 0.11, 0.0}}};
  world.rectangles.insert(world.rectangles.end(), others.begin(), others.end());
  return world;
}

/// What a detector says of a rectangle that faces the camera, of these sides (m): a box larger by a share.
inline ImageRegion boxOf(const cv::Vec3d& middle, double width, double height, const CameraModel& camera,
                         double margin = 0.0)
{
  const cv::Vec3d half(0.5 * width, 0.5 * height, 0.0);
  const cv::Point2d one = camera.project(cv::Point3d(middle - (1.0 + margin) * half));
  const cv::Point2d other = camera.project(cv::Point3d(middle + (1.0 + margin) * half));
  ImageRegion region;
  const cv::Point first(cvRound(one.x), cvRound(one.y)), last(cvRound(other.x), cvRound(other.y));
  region.box = cv::Rect(first, last + cv::Point(1, 1));
  return region;
}

inline ImageRegion faceBox(const CameraModel& camera, double margin = 0.15)
{
  return boxOf(kFace, 0.16, 0.22, camera, margin);
}

inline std::optional<LocatedRegion> locate(const cv::Mat& depth, const CameraModel& camera, const ImageRegion& region,
                                           const LocatorParams& params = {})
{
  return RegionLocator(camera, params).locate(depth, depth.type() == CV_16UC1 ? "16UC1" : "32FC1", region);
}

inline LocatorParams sphere()
{
  LocatorParams params;
  params.shape = "sphere";
  return params;
}

/// The smallest circle around what a camera sees of a sphere, and the box around that.
inline ImageRegion circleOf(const WorldSphere& ball, const CameraModel& camera)
{
  const double distance = cv::norm(ball.middle), sine = ball.radius / distance, cosine = std::sqrt(1.0 - sine * sine);
  const cv::Vec3d axis = ball.middle / distance, side = cv::normalize(axis.cross(cv::Vec3d(0.0, 1.0, 0.0)));
  const cv::Vec3d up = axis.cross(side);
  std::vector<cv::Point2f> rim;
  for (double angle = 0.0; angle < 2.0 * CV_PI; angle += 0.1)
  {
    const cv::Vec3d off = std::cos(angle) * side + std::sin(angle) * up;
    rim.emplace_back(camera.project(cv::Point3d(cosine * axis + sine * off)));
  }
  cv::Point2f center;
  float radius = 0.0F;
  cv::minEnclosingCircle(rim, center, radius);
  ImageRegion region;
  region.center = cv::Point2d(center);
  region.radius = radius;
  region.box = cv::boundingRect(rim);
  return region;
}

inline double distanceTo(const cv::Vec3d& truth, const std::optional<LocatedRegion>& found)
{
  return found ? cv::norm(cv::Vec3d(found->position) - truth) : std::numeric_limits<double>::infinity();
}

/// The squared error in its variances.
inline double squaredError(const cv::Vec3d& truth, const LocatedRegion& found)
{
  const cv::Vec3d error = cv::Vec3d(found.position) - truth;
  return error.dot(found.covariance.inv(cv::DECOMP_CHOLESKY) * error);
}

inline void expectUsable(const LocatedRegion& found)
{
  const cv::Matx33d& covariance = found.covariance;
  EXPECT_TRUE(std::isfinite(cv::norm(found.position)) && found.position.z > 0.0);
  EXPECT_TRUE(std::isfinite(cv::norm(covariance)) && covariance == covariance.t());
  bool definite = false;
  (covariance * (1.0 / cv::norm(covariance))).inv(cv::DECOMP_CHOLESKY, &definite);
  EXPECT_TRUE(definite);
  for (const double side : found.size.val)
    EXPECT_TRUE(std::isfinite(side) && side >= 0.0);
}

}  // namespace depth_regions
