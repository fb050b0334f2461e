#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// How wrong the distances of a depth camera are. The defaults are those of a Kinect: its noise along the line of sight
/// (Nguyen, Izadi, Lovell: Modeling Kinect Sensor Noise, 3DIMPVT 2012) and the steps of its disparity, an eighth of a
/// pixel.
struct DepthErrorParams
{
  double depth_noise = 0.0012;
  double depth_noise_growth = 0.0019;
  double depth_step = 0.0029;
  double depth_bias = 0.005;
  int depth_correlation = 4;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("depth_noise", &DepthErrorParams::depth_noise, Range{0.00001, 1}, "m",
          "standard deviation of a depth of at most 0.4 m");
    visit("depth_noise_growth", &DepthErrorParams::depth_noise_growth, Range{0, 1}, "1/m",
          "what it grows by with the square of the depth beyond 0.4 m");
    visit("depth_step", &DepthErrorParams::depth_step, Range{0, 1}, "1/m",
          "between the depths that the sensor can tell apart, divided by the square of the depth");
    visit("depth_bias", &DepthErrorParams::depth_bias, Range{0, 1}, "m",
          "standard deviation of what all depths of a tag have in common");
    visit("depth_correlation", &DepthErrorParams::depth_correlation, Range{1, 1000}, "px",
          "how many neighbouring pixels share their noise");
  }
};

/// A plane that a depth image shows. The point of the plane on the ray (x, y, 1) of the camera's optical frame has the
/// depth 1 / (a x + b y + c).
struct DepthPlane
{
  cv::Vec3d inverse_depth;  // a, b and c, 1/m
  cv::Matx33d covariance;   // of the three, 1/m^2
  int pixels = 0;           // whose depths agree with it
};

/// Throws std::invalid_argument unless the plane is finite and its covariance symmetric and positive definite.
void validate(const DepthPlane& plane);

/// Measures the plane of a tag whose corners (px, in their order around it) were found in the image of a camera.
/// `depth` has that camera's size, lens and optical frame, as registered depth has: CV_32FC1 in m, where what is not
/// finite or not positive is unknown, or CV_16UC1 in mm, 0 where it is unknown (REP 118). Depths that do not agree with
/// the plane of most are left out. The result is empty if there are too few, and if they scatter much more than
/// `params` tell. Throws std::invalid_argument for an image of another type or size, and for a parameter out of range.
std::optional<DepthPlane> measureTagPlane(const cv::Mat& depth, const std::array<cv::Point2d, 4>& corners,
                                          const CameraModel& camera,
                                          const DepthErrorParams& params = DepthErrorParams());

}  // namespace robot_vision
