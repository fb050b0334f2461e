#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

// Places on the floor are in the robot's frame of REP 103: x ahead, y to the left, m.

struct GroundParams
{
  std::string ground = "camera";
  double camera_height = 0.25;
  double pitch = 0.6;
  double camera_x = 0.0;
  double camera_y = 0.0;
  double near = 0.2;
  double far = 1.2;
  double view_width = 1.2;
  double resolution = 0.005;
  double near_row = 0.95;
  double near_left = 0.1;
  double near_right = 0.9;
  double far_row = 0.4;
  double far_left = 0.4;
  double far_right = 0.6;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("ground", &GroundParams::ground, OneOf{"camera or points"}, "",
          "what tells where the floor is: camera_info and the camera's mounting, or four points of the image");
    visit("camera_height", &GroundParams::camera_height, Above{0, 100}, "m", "camera: above the floor");
    visit("pitch", &GroundParams::pitch, Range{0, 1.6}, "rad", "camera: by which it looks down");
    visit("camera_x", &GroundParams::camera_x, Range{-100, 100}, "m", "camera: ahead of the robot's origin");
    visit("camera_y", &GroundParams::camera_y, Range{-100, 100}, "m", "camera: to the left of the robot's origin");
    visit("near", &GroundParams::near, Range{0, 1000}, "m", "where the view from above begins, ahead of the robot");
    visit("far", &GroundParams::far, Above{0, 1000}, "m", "where the view from above ends, beyond near");
    visit("view_width", &GroundParams::view_width, Above{0, 1000}, "m", "width of the view from above");
    visit("resolution", &GroundParams::resolution, Above{0, 10}, "m", "side of a pixel of the view from above");
    visit("near_row", &GroundParams::near_row, Range{-2, 3}, "",
          "points: where a straight lane is, near ahead: 0 at the image's top to 1 at its bottom");
    visit("near_left", &GroundParams::near_left, Range{-2, 3}, "",
          "points: its left line in this row: 0 at the image's left to 1 at its right");
    visit("near_right", &GroundParams::near_right, Range{-2, 3}, "", "points: its right line in this row");
    visit("far_row", &GroundParams::far_row, Range{-2, 3}, "", "points: where the lane is, far ahead");
    visit("far_left", &GroundParams::far_left, Range{-2, 3}, "", "points: its left line in this row");
    visit("far_right", &GroundParams::far_right, Range{-2, 3}, "", "points: its right line in this row");
  }
};

/// Throws std::invalid_argument for the first parameter out of range, for limits in the wrong order, and for a view
/// that would have fewer than 20 or more than 1000 px in one direction.
void validate(const GroundParams& params);

/// The floor ahead of a robot as a camera sees it, and as it would look from above. It never changes, so threads may
/// share one.
class GroundView
{
public:
  /// By a camera with its lens, mounted as the parameters say. Throws as validate() of both does.
  GroundView(const GroundParams& params, const CameraModel& camera);

  /// By the four points of an image of `size` (px), which are the corners of a rectangle on the floor: `lane_width` (m)
  /// wide, and from `near` to `far`.
  GroundView(const GroundParams& params, double lane_width, const cv::Size& size);

  /// The size of the images that are viewed, px.
  const cv::Size& imageSize() const { return image_size_; }

  /// Where a place on the floor (m) is in the image, px; it may lie outside of it. NaN if the camera cannot see it.
  cv::Point2d toImage(const cv::Point2d& place) const;

  /// Where it is in the view from above, px.
  cv::Point2d toView(const cv::Point2d& place) const;

  /// The place on the floor (m) of a pixel position of the view from above.
  cv::Point2d toGround(const cv::Point2d& view) const;

  /// The view from above, ahead upwards: CV_8UC3, black where the camera sees nothing. `bgr` is CV_8UC3 of imageSize().
  void fromAbove(const cv::Mat& bgr, cv::Mat& view) const;

  /// What of that view the camera sees: CV_8UC1, 0 or 255.
  const cv::Mat& seen() const { return seen_; }

private:
  void makeMap();
  cv::Point2d throughLens(const cv::Point2d& place) const;

  GroundParams params_;
  cv::Size image_size_;
  CameraModel camera_;          // with ground "camera"
  cv::Matx33d floor_to_image_;  // with ground "points"
  cv::Mat map_, map_fraction_;  // of cv::remap
  cv::Mat seen_;
};

}  // namespace robot_vision
