#pragma once

#include <cmath>
#include <opencv2/core.hpp>

#include "measure.hpp"
#include "robot_vision/depth/depth_normals.hpp"
#include "robot_vision/depth/depth_points.hpp"

namespace bench
{

/// Points and normals as cv::ppf_match_3d has them, of each `step`-th pixel of each `step`-th row.
inline cv::Mat cloudOf(const cv::Mat& depth, const robot_vision::CameraModel& camera, int step)
{
  cv::Mat points, normals;
  robot_vision::DepthPoints(camera).points(depth, "32FC1", points);
  robot_vision::DepthNormals(camera).apply(depth, "32FC1", normals);
  cv::Mat cloud(0, 6, CV_32FC1);
  for (int y = 0; y < depth.rows; y += step)
    for (int x = 0; x < depth.cols; x += step)
    {
      const cv::Vec3f point = points.at<cv::Vec3f>(y, x), normal = normals.at<cv::Vec3f>(y, x);
      if (std::isnan(point[2]) || std::isnan(normal[2])) continue;
      const float row[] = {point[0], point[1], point[2], normal[0], normal[1], normal[2]};
      cloud.push_back(cv::Mat(1, 6, CV_32FC1, const_cast<float*>(row)));
    }
  return cloud;
}

}  // namespace bench
