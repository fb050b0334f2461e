#pragma once

#include <string>

#include "v4l2_cameras.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// The names of a camera, a line each.
std::string reportNames(const V4l2Camera& camera);

struct CameraReport
{
  std::string text;
  bool complete;  // else the camera could not be asked, and the text says why
};

/// All of it, of a camera that may have vanished since it was listed.
CameraReport reportCamera(const V4l2Camera& camera, const V4l2System& system = {});

/// The formats that a device offers, with sizes and rates, and its controls, a line each.
std::string reportModes(V4l2Device& device);
std::string reportControls(V4l2Device& device);

}  // namespace robot_vision
