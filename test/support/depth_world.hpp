#pragma once

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <vector>

#include "robot_vision/depth/depth_registration.hpp"
#include "robot_vision/geometry/camera_model.hpp"

/// A rectangle by its middle and the halves of two sides, m.
struct WorldRectangle
{
  cv::Vec3d middle, right, down;
};

struct WorldSphere
{
  cv::Vec3d middle;
  double radius;
};

/// What a ray meets first: the distance, in lengths of its direction, and which surface.
struct WorldHit
{
  double distance = std::numeric_limits<double>::infinity();
  int surface = -1;
};

/// Surfaces of known geometry, in the optical frame of a depth camera: x right, y down, z forward, m.
struct DepthWorld
{
  using CameraModel = robot_vision::CameraModel;

  std::vector<WorldRectangle> rectangles;
  std::vector<WorldSphere> spheres;

  WorldHit hit(const cv::Vec3d& from, const cv::Vec3d& direction) const
  {
    WorldHit nearest;
    int surface = 0;
    const auto consider = [&](double distance)
    {
      if (distance > 1e-9 && distance < nearest.distance) nearest = {distance, surface};
      ++surface;
    };
    for (const WorldRectangle& rectangle : rectangles)
      consider(distanceTo(rectangle, from, direction));
    for (const WorldSphere& sphere : spheres)
      consider(distanceTo(sphere, from, direction));
    return nearest;
  }

  /// What a camera at this pose sees: exact z in its optical frame (CV_32FC1, m), NaN where there is nothing.
  cv::Mat depth(const CameraModel& camera, const cv::Affine3d& pose = cv::Affine3d::Identity()) const
  {
    cv::Mat seen(camera.height, camera.width, CV_32FC1);
    for (int y = 0; y < seen.rows; ++y)
      for (int x = 0; x < seen.cols; ++x)
      {
        const double z = hitAt(camera, pose, cv::Point2d(x, y)).distance;
        seen.at<float>(y, x) = std::isinf(z) ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(z);
      }
    return seen;
  }

  /// What a camera at this pose sees at a pixel position; the distance is z in its optical frame.
  WorldHit hitAt(const CameraModel& camera, const cv::Affine3d& pose, const cv::Point2d& pixel) const
  {
    const cv::Point2d ray = camera.ray(pixel);
    if (std::isnan(ray.x)) return {};
    return hit(pose.translation(), pose.rotation() * cv::Vec3d(ray.x, ray.y, 1.0));
  }

private:
  static double distanceTo(const WorldRectangle& rectangle, const cv::Vec3d& from, const cv::Vec3d& direction)
  {
    const cv::Vec3d normal = rectangle.right.cross(rectangle.down);
    const double distance = normal.dot(rectangle.middle - from) / normal.dot(direction);
    const cv::Vec3d at = from + distance * direction - rectangle.middle;
    const bool inside = std::abs(at.dot(rectangle.right)) <= rectangle.right.dot(rectangle.right) &&
                        std::abs(at.dot(rectangle.down)) <= rectangle.down.dot(rectangle.down);
    return inside ? distance : -1.0;
  }

  static double distanceTo(const WorldSphere& sphere, const cv::Vec3d& from, const cv::Vec3d& direction)
  {
    const cv::Vec3d to = sphere.middle - from;
    const double a = direction.dot(direction), b = direction.dot(to), c = to.dot(to) - sphere.radius * sphere.radius;
    const double root = b * b - a * c;
    return root < 0.0 ? -1.0 : (b - std::sqrt(root)) / a;
  }
};

/// A camera with this width, images of 4:3, about 60 degrees of view and its axis near the middle.
inline robot_vision::CameraModel depthWorldCamera(int width, const std::vector<double>& D = {},
                                                  const std::string& distortion_model = "plumb_bob")
{
  const double f = 0.85 * width;
  const int height = width * 3 / 4;
  return {width, height, {f, 0, 0.5 * width + 0.3, 0, 1.01 * f, 0.5 * height - 0.7, 0, 0, 1}, D, distortion_model};
}

// Lenses for such a camera.
const std::vector<double> kBentLens = {-0.28, 0.09, 0.001, -0.002, 0.01};
const std::vector<double> kRationalLens = {0.05, 0.02, 0.001, -0.002, 0.005, 0.2, 0.01, 0.002};
const std::vector<double> kFisheyeLens = {0.05, -0.02, 0.006, -0.001};

/// A wall, a table in front of it, a box face and a ball.
inline DepthWorld furnishedWorld()
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 3.0}, {6.0, 0.0, 1.0}, {0.0, 6.0, 0.0}},
                      {{0.1, 0.7, 2.0}, {0.6, 0.0, 0.0}, {0.0, 0.25, -0.7}},
                      {{-0.3, -0.1, 1.6}, {0.25, 0.02, 0.05}, {0.0, 0.2, 0.02}}};
  world.spheres = {{{0.35, 0.0, 1.9}, 0.2}};
  return world;
}

/// Where a color camera is, in the depth camera's optical frame: turned by a rotation vector, rad, and at a place, m.
inline cv::Affine3d colorPose(const cv::Vec3d& turn = {}, const cv::Vec3d& place = {0.025, 0.0, 0.0})
{
  return {turn, place};
}

/// The depth that a color camera at this pose sees.
inline cv::Mat registered(const cv::Mat& depth, const robot_vision::CameraModel& from,
                          const robot_vision::CameraModel& to, const cv::Affine3d& pose,
                          const robot_vision::RegistrationParams& params = robot_vision::RegistrationParams())
{
  cv::Mat result;
  robot_vision::DepthRegistration registration(from, to, pose.inv(), params);
  registration.apply(depth, depth.type() == CV_16UC1 ? "16UC1" : "32FC1", result);
  return result;
}
