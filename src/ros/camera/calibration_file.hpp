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

/// The path of the calibration file at a URL, file:///... or package://..., in which ${NAME} and ${ROS_HOME} are
/// replaced; of an empty one ${ROS_HOME}/camera_info/${NAME}.yaml. Throws std::invalid_argument naming camera_info_url.
std::string calibrationPath(const std::string& url, const std::string& camera_name);

/// Parses the text of a calibration file of camera_info_manager or camera_calibration, and sets the camera's name to
/// that in the file. Throws std::runtime_error if the text cannot be read. Whether the values are valid is not checked.
sensor_msgs::CameraInfo parseCalibration(const std::string& text, CalibrationFormat format, std::string& camera_name);

/// The text of such a file; empty if it could not be read back, as some INI files of camera_calibration_parsers.
std::string calibrationText(const sensor_msgs::CameraInfo& info, CalibrationFormat format,
                            const std::string& camera_name);

/// Reads and parses a calibration file. Throws std::runtime_error that names the path.
sensor_msgs::CameraInfo readCalibration(const std::string& path, std::string& camera_name);

/// Writes a calibration file, and its folder, or replaces the file in one step. Throws std::runtime_error that names
/// the path.
void writeCalibration(const std::string& path, const sensor_msgs::CameraInfo& info, const std::string& camera_name);

}  // namespace robot_vision
