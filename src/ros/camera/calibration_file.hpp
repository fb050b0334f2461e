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

/// Parses the text of a calibration file of camera_info_manager or camera_calibration, and sets the camera's name to
/// that in the file. Throws std::runtime_error if the text cannot be read. Whether the values are valid is not checked.
sensor_msgs::CameraInfo parseCalibration(const std::string& text, CalibrationFormat format, std::string& camera_name);

/// The text of such a file; empty if it could not be read back, as some INI files of camera_calibration_parsers.
std::string calibrationText(const sensor_msgs::CameraInfo& info, CalibrationFormat format,
                            const std::string& camera_name);

}  // namespace robot_vision
