#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

struct RegistrationParams
{
  double max_jump = 0.05;
  int threads = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("max_jump", &RegistrationParams::max_jump, Range{0.001, 1}, "",
          "largest difference of depth between neighbours on one surface, as share of the depth");
    visit("threads", &RegistrationParams::threads, Range{1, 64}, "",
          "number of threads that share an image, as far as OpenCV's setting allows");
  }
};

/// Makes of the images of a depth camera those that a depth camera in the place of the color camera, with its lens and
/// its image size, would have.
///
/// Each four neighbours of the depth image are two triangles, of those parts that max_jump allows to be one surface.
/// They are drawn into the color image, whatever its size; what is nearest is seen. Between the corners of a triangle
/// the inverse of the depth is linear, as it is on a plane. A pixel without a depth sees what the depth camera does
/// not: something beside its image, behind something else, or without a depth there.
///
/// The result is the same with any number of threads. Memory is kept from frame to frame. For one thread at a time.
class DepthRegistration
{
public:
  /// `depth_to_color` takes points (m) of the depth camera's optical frame to that of the color camera. Throws
  /// std::invalid_argument as validate() of the cameras and of the parameters does, for images with more than 8192 px
  /// in a row or column, or for a transform that is not one of a rigid body.
  DepthRegistration(const CameraModel& depth_camera, const CameraModel& color_camera,
                    const cv::Affine3d& depth_to_color, const RegistrationParams& params = RegistrationParams());
  ~DepthRegistration();

  /// Changes where the cameras are to each other, which takes no time. Throws as the constructor does.
  void setTransform(const cv::Affine3d& depth_to_color);

  /// Writes the depth of each pixel of the color camera into `registered`, which is reused if it fits: CV_16UC1 (mm, 0:
  /// none) for an image of 16UC1 or mono16, CV_32FC1 (m, NaN: none) for one of 32FC1. Throws std::invalid_argument if
  /// `depth` is not of `encoding`, or not of the depth camera's size.
  void apply(const cv::Mat& depth, const std::string& encoding, cv::Mat& registered);

  /// The encoding of what apply() writes: 32FC1 for 32FC1, else 16UC1.
  static std::string outputEncoding(const std::string& encoding) { return encoding == "32FC1" ? "32FC1" : "16UC1"; }

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
