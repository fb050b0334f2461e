#pragma once

#include <memory>
#include <opencv2/core/affine.hpp>

#include "registration_input.hpp"
#include "robot_vision/depth/depth_points.hpp"
#include "robot_vision/depth/depth_registration.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// The registration and the rays of two cameras, which are made anew only when a calibration or a parameter is another
/// one.
class RegistrationCameras
{
public:
  struct Params
  {
    RegistrationParams registration;
    bool depth_rectified = false;  // whether the images are rectified, so that their camera is P of camera_info
    bool color_rectified = false;
  };

  /// Throws std::invalid_argument as validate() of the RegistrationParams does.
  void configure(const Params& params);

  /// Sets the calibrations of a frame, and where its cameras are to each other. Throws std::invalid_argument naming the
  /// topic of what no camera can have.
  void set(const RegistrationFrame& frame, const RegistrationTopics& topics, const cv::Affine3d& depth_to_color);

  // Only to be called after set().
  DepthRegistration& registration() { return *registration_; }
  cv::Size colorSize() const { return {color_.width, color_.height}; }
  /// What makes points of the registered images.
  std::shared_ptr<const DepthPoints> points();

private:
  Params params_;
  CameraModel depth_, color_;
  cv::Affine3d depth_to_color_;
  std::unique_ptr<DepthRegistration> registration_;
  std::shared_ptr<const DepthPoints> points_;  // of the color camera; made when it is asked for
};

}  // namespace robot_vision
