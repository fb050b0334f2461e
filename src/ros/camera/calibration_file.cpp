#include "calibration_file.hpp"

#include <camera_calibration_parsers/parse_ini.h>
#include <camera_calibration_parsers/parse_yml.h>

#include <sstream>
#include <stdexcept>

#include "robot_vision/common/printable.hpp"
#include "ros/params/bounded_yaml.hpp"

namespace robot_vision
{

constexpr std::size_t kMaxReasonLength = 200;  // bytes, of an error's text

sensor_msgs::CameraInfo parseCalibration(const std::string& text, CalibrationFormat format, std::string& camera_name)
{
  const bool ini = format == CalibrationFormat::kIni;
  const std::string none = "no calibration that can be read";
  sensor_msgs::CameraInfo info;
  std::istringstream stream(text);
  try
  {
    if (!ini) requireBoundedYaml(text);
    if (ini ? camera_calibration_parsers::readCalibrationIni(stream, camera_name, info)
            : camera_calibration_parsers::readCalibrationYml(stream, camera_name, info))
      return info;
  }
  catch (const std::exception& e)
  {
    throw std::runtime_error(none + ": " + printable(e.what(), kMaxReasonLength));  // the text may quote the file
  }
  throw std::runtime_error(none);
}

std::string calibrationText(const sensor_msgs::CameraInfo& info, CalibrationFormat format,
                            const std::string& camera_name)
try
{
  std::ostringstream text;
  const bool written = format == CalibrationFormat::kIni
                           ? camera_calibration_parsers::writeCalibrationIni(text, camera_name, info)
                           : camera_calibration_parsers::writeCalibrationYml(text, camera_name, info);
  std::string of_camera;
  const bool read = written && parseCalibration(text.str(), format, of_camera).width == info.width;
  return read && of_camera == camera_name ? text.str() : "";
}
catch (const std::runtime_error&)
{
  return "";
}

}  // namespace robot_vision
