#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/meshes/mesh_renderer.hpp"

namespace robot_vision
{

/// Where the rays of a lens are seen, and how far from straight it shows what is straight.
struct MeshCamera::Lens
{
  explicit Lens(const CameraModel& camera);

  /// The pixel position of the ray (x, y, 1), within `margin` of the true one. Beyond what the camera sees it goes on
  /// as at the border.
  cv::Point2d pixel(double x, double y) const;

  cv::Size size;  // px
  cv::Mat xs,
      ys;  // CV_32FC1: the rays of the pixels, 0 where there is none; rows are Raster::kLanes longer than the image
  cv::Mat unseen;  // CV_8UC1 of the image's size: 255 where there is no ray; empty: there is one everywhere
  double margin;   // px
  double bend;     // 1/px: times the square of the length of a line (px) it is how far the line may bend

private:
  cv::Point2d node(int column, int row) const { return nodes_.at<cv::Point2d>(row, column); }
  void measure(const CameraModel& camera);

  // The sines of angles from the optical axis, across and down, as those of rays at 90 degrees are finite.
  cv::Point2d first_, step_;  // of the first node, and between two of them
  cv::Mat nodes_;             // CV_64FC2: pixel positions
};

}  // namespace robot_vision
