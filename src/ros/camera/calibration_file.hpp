#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace robot_vision
{

enum class CalibrationFormat
{
  kYaml,
  kIni
};

/// A calibration from the text of a file, as camera_info_manager and camera_calibration have it, and the name of its
/// camera, as it is there. Throws std::runtime_error if it is none that can be read; whether any camera can have it is
/// not looked at.
sensor_msgs::CameraInfo parseCalibration(const std::string& text, CalibrationFormat format, std::string& camera_name);

/// The text of such a file; empty if it could not be read again, as the INI that camera_calibration_parsers writes.
std::string calibrationText(const sensor_msgs::CameraInfo& info, CalibrationFormat format,
                            const std::string& camera_name);

}  // namespace robot_vision
