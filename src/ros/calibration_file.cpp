#include "calibration_file.hpp"

#include <camera_calibration_parsers/parse_ini.h>
#include <camera_calibration_parsers/parse_yml.h>

#include <sstream>
#include <stdexcept>

#include "bounded_yaml.hpp"
#include "robot_vision/printable.hpp"

namespace robot_vision
{

constexpr std::size_t kMaxTold = 200;  // bytes of what is wrong

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
    throw std::runtime_error(none + ": " + printable(e.what(), kMaxTold));  // it may quote what is there
  }
  throw std::runtime_error(none);
}

}  // namespace robot_vision
