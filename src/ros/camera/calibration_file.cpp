#include "calibration_file.hpp"

#include <camera_calibration_parsers/parse_ini.h>
#include <camera_calibration_parsers/parse_yml.h>
#include <pwd.h>
#include <ros/package.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/common/regular_file.hpp"
#include "robot_vision/common/replace_file.hpp"
#include "ros/params/bounded_yaml.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxReasonLength = 200;  // bytes, of an error's text
constexpr int kMaxCoefficients = 14;           // of a distortion, in OpenCV's models
const std::string kFile = "file://";
const std::string kPackage = "package://";
const std::string kDefaultUrl = "file://${ROS_HOME}/camera_info/${NAME}.yaml";

std::string environmentVariable(const char* name)
{
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// The user's home folder, also for system services, which have no HOME.
std::string userHome()
{
  const std::string home = environmentVariable("HOME");
  const passwd* user = home.empty() ? getpwuid(getuid()) : nullptr;
  return user == nullptr ? home : user->pw_dir;
}

std::string rosHome()
{
  const std::string home = environmentVariable("ROS_HOME");
  // A relative path is relative to the node's working folder.
  return std::filesystem::absolute(home.empty() ? userHome() + "/.ros" : home).string();
}

/// The path of a file in a package, given as "package/file"; empty if there is no such package.
std::string pathInPackage(const std::string& name_and_path)
{
  const std::size_t slash = name_and_path.find('/');
  if (slash == std::string::npos || slash + 1 == name_and_path.size()) return "";
  const std::string folder = ros::package::getPath(name_and_path.substr(0, slash));
  return folder.empty() ? "" : folder + name_and_path.substr(slash);
}

CalibrationFormat formatOf(const std::string& path)
{
  return std::filesystem::path(path).extension() == ".ini" ? CalibrationFormat::kIni : CalibrationFormat::kYaml;
}

struct MatrixSize
{
  int rows, columns;
  int numbers;  // of the data, which may be others
};

MatrixSize sizeOf(const YAML::Node& calibration, const std::string& name)
{
  const YAML::Node matrix = calibration[name];
  return {matrix["rows"].as<int>(), matrix["cols"].as<int>(), static_cast<int>(matrix["data"].size())};
}

void requireSize(bool ok, const std::string& name, const MatrixSize& size, const std::string& expected)
{
  require(ok, name, sizeText(size.rows, size.columns) + " with " + std::to_string(size.numbers) + " numbers",
          expected + " with as many");
}

/// camera_calibration_parsers believes the sizes in a file: with others than these its assertions end the process, or
/// it writes beyond its matrices. Throws std::invalid_argument for those.
void requireMatrices(const YAML::Node& calibration)
{
  const std::pair<std::string, int> matrices[] = {
      {"camera_matrix", 3}, {"rectification_matrix", 3}, {"projection_matrix", 4}};
  for (const auto& [name, columns] : matrices)
  {
    const MatrixSize size = sizeOf(calibration, name);
    const bool ok = size.rows == 3 && size.columns == columns && size.numbers == 3 * columns;
    requireSize(ok, name, size, sizeText(3, columns));
  }
  const MatrixSize lens = sizeOf(calibration, "distortion_coefficients");
  const bool bounded = std::max({lens.rows, lens.columns, lens.numbers}) <= kMaxCoefficients;
  const bool ok = bounded && std::min(lens.rows, lens.columns) >= 0 && lens.rows * lens.columns == lens.numbers;
  requireSize(ok, "distortion_coefficients", lens, "1x0 to " + sizeText(1, kMaxCoefficients));
}

}  // namespace

std::string calibrationPath(const std::string& url, const std::string& camera_name)
{
  std::string resolved = url.empty() ? kDefaultUrl : url;
  boost::algorithm::replace_all(resolved, "${NAME}", camera_name);
  boost::algorithm::replace_all(resolved, "${ROS_HOME}", rosHome());
  const std::string quoted_url = "'" + url + "'";
  if (resolved.rfind(kPackage, 0) == 0)
  {
    const std::string path = pathInPackage(resolved.substr(kPackage.size()));
    require(!path.empty(), "camera_info_url", quoted_url,
            "package://, the name of a package that is there, / and a file");
    return path;
  }
  const bool is_file = resolved.rfind(kFile + "/", 0) == 0;
  require(is_file, "camera_info_url", quoted_url, "empty, file:///... or package://...");
  return resolved.substr(kFile.size());
}

sensor_msgs::CameraInfo parseCalibration(const std::string& text, CalibrationFormat format, std::string& camera_name)
{
  const bool ini = format == CalibrationFormat::kIni;
  const std::string none = "no calibration that can be read";
  sensor_msgs::CameraInfo info;
  std::istringstream stream(text);
  try
  {
    if (!ini)
    {
      requireBoundedYaml(text);
      requireMatrices(YAML::Load(text));
    }
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

sensor_msgs::CameraInfo readCalibration(const std::string& path, std::string& camera_name)
{
  const std::string text = readFile(path, kMaxYamlText);
  try
  {
    return parseCalibration(text, formatOf(path), camera_name);
  }
  catch (const std::exception& e)
  {
    throw std::runtime_error(path + " is " + e.what());
  }
}

void writeCalibration(const std::string& path, const sensor_msgs::CameraInfo& info, const std::string& camera_name)
{
  const std::filesystem::path file(path);
  if (file.extension() != ".ini" && file.extension() != ".yaml" && file.extension() != ".yml")
    throw std::runtime_error(path + ": the name must end in .yaml, .yml or .ini");
  const std::string text = calibrationText(info, formatOf(path), camera_name);
  if (text.empty()) throw std::runtime_error(path + ": this format cannot hold the calibration, .yaml can");
  std::filesystem::create_directories(file.parent_path());
  replaceFile(path, text);
}

}  // namespace robot_vision
