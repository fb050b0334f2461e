#pragma once

#include <string>

#include "v4l2_cameras.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// The names of a camera, one on each line.
std::string reportNames(const V4l2Camera& camera);

struct CameraReport
{
  std::string text;
  bool complete;  // false if the camera could not be queried; then the text gives the reason
};

/// The names, formats and controls of a camera. The camera may have vanished since it was listed.
CameraReport reportCamera(const V4l2Camera& camera, const V4l2System& system = {});

/// The formats that a device offers, with sizes and rates, and its controls, one on each line.
std::string reportModes(V4l2Device& device);
std::string reportControls(V4l2Device& device);

}  // namespace robot_vision
