#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "robot_vision/tags/pose/tag_pose.hpp"

const double kSize = 0.2;  // m, of a tag
const cv::Matx33d kK(600, 0, 320, 0, 600, 240, 0, 0, 1);

/// A tag that faces the camera, then turned by a rotation vector (rad) along the camera's axes.
inline cv::Affine3d facing(const cv::Vec3d& turn, const cv::Vec3d& place)
{
  return {cv::Affine3d(turn).rotation() * cv::Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1), place};
}

inline robot_vision::TagCorners seen(const robot_vision::BundleTag& tag, const cv::Affine3d& body,
                                     const robot_vision::CameraModel& camera)
{
  const double half = tag.size / 2.0;
  const cv::Affine3d pose = body * tag.pose;
  return {tag.id,
          {camera.project(pose * cv::Point3d(-half, -half, 0)), camera.project(pose * cv::Point3d(half, -half, 0)),
           camera.project(pose * cv::Point3d(half, half, 0)), camera.project(pose * cv::Point3d(-half, half, 0))}};
}

inline robot_vision::TagCorners seenTag(const cv::Affine3d& pose, const robot_vision::CameraModel& camera, int id = 0)
{
  return seen(robot_vision::singleTag(id, kSize).tags[0], pose, camera);
}

inline double angleBetween(const cv::Affine3d& a, const cv::Affine3d& b)
{
  return cv::norm(cv::Affine3d(a.rotation() * b.rotation().t()).rvec());
}

inline double distanceBetween(const cv::Affine3d& a, const cv::Affine3d& b)
{
  return cv::norm(a.translation() - b.translation());
}
