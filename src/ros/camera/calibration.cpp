#include "calibration.hpp"

#include <pwd.h>
#include <ros/package.h>
#include <unistd.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <boost/make_shared.hpp>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "calibration_file.hpp"
#include "core/common/regular_file.hpp"
#include "core/common/replace_file.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/images/bounded_reading.hpp"
#include "ros/params/bounded_yaml.hpp"
#include "scene_messages.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxName = 200;  // bytes, because it is part of a file's name
const std::string kFile = "file://";
const std::string kPackage = "package://";
const std::string kDefaultUrl = "file://${ROS_HOME}/camera_info/${NAME}.yaml";

bool isName(const std::string& text)
{
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !text.empty() && text.size() <= kMaxName && std::all_of(text.begin(), text.end(), fits);
}

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

std::string pathOf(const std::string& url, const std::string& camera_name)
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

CalibrationFormat formatOf(const std::string& path)
{
  return std::filesystem::path(path).extension() == ".ini" ? CalibrationFormat::kIni : CalibrationFormat::kYaml;
}

/// Reads a calibration file; throws std::runtime_error that names it.
sensor_msgs::CameraInfo parse(const std::string& path, std::string& camera_name)
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

CameraModel modelOf(const sensor_msgs::CameraInfo& info)
{
  CameraModel model;
  constexpr std::uint32_t kMaxInt = std::numeric_limits<int>::max();
  model.width = static_cast<int>(std::min(info.width, kMaxInt));
  model.height = static_cast<int>(std::min(info.height, kMaxInt));
  model.K = cv::Matx33d(info.K.data());
  model.D = info.D;
  model.distortion_model = info.distortion_model;
  return model;
}

/// Throws std::invalid_argument naming what is not valid for a camera with images of this size (empty: any size).
void requireUsable(const sensor_msgs::CameraInfo& info, cv::Size size)
{
  const std::string as_in_images = " as in the camera's images";
  if (!size.empty())
  {
    require(info.width == static_cast<std::uint32_t>(size.width), "width", info.width,
            toText(size.width) + as_in_images);
    require(info.height == static_cast<std::uint32_t>(size.height), "height", info.height,
            toText(size.height) + as_in_images);
  }
  validate(modelOf(info));
  validateRectification(cv::Matx33d(info.R.data()), cv::Matx34d(info.P.data()));
}

/// The reason why a calibration that was read from a file is not valid; empty if it is valid.
std::string problemOf(const sensor_msgs::CameraInfo& info)
try
{
  requireUsable(info, {});
  return "";
}
catch (const std::invalid_argument& e)
{
  return e.what();
}

}  // namespace

Calibration::Calibration(const ros::NodeHandle& pnh, const std::string& camera_name, const std::string& url)
  : name_(pnh.getNamespace()), camera_name_(camera_name), has_url_(!url.empty())
{
  require(isName(camera_name), "camera_name", "'" + camera_name + "'",
          "letters, digits and _, " + std::to_string(kMaxName) + " at most");
  path_ = pathOf(url, camera_name);
  auto service = boundedService<sensor_msgs::SetCameraInfo>(
      "set_camera_info", [this](auto& request, auto& response) { return onSet(request, response); });
  service_ = ros::NodeHandle(pnh).advertiseService(service);
}

void Calibration::setModel(const CameraModel* model)
{
  model_ = model == nullptr ? nullptr : std::make_unique<sensor_msgs::CameraInfo>(toCameraInfo(*model));
  if (!model_) return;
  setImageSize({model->width, model->height});
  if (has_url_)
    ROS_INFO("%s: camera_info is that of camera_info_url, if it has one, else the scene's own", name_.c_str());
  else
    ROS_INFO("%s: camera_info is the scene's own, exact; camera_info_url can name another", name_.c_str());
}

void Calibration::setImageSize(cv::Size size)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  size_ = size;
}

sensor_msgs::CameraInfoPtr Calibration::info(cv::Size size, const std_msgs::Header& header)
{
  const auto width = static_cast<std::uint32_t>(size.width);
  const auto height = static_cast<std::uint32_t>(size.height);
  const auto fits = [=](const sensor_msgs::CameraInfo& info) { return info.width == width && info.height == height; };
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(model_ && !has_url_ ? *model_ : stored());
  const bool calibrated = info->K[0] != 0.0;
  if (calibrated && !fits(*info) && wrong_size_.due())
    ROS_WARN("%s: the calibration is for %ux%u, the picture has %ux%u: it is not used", name_.c_str(), info->width,
             info->height, width, height);
  if (!calibrated || !fits(*info)) *info = model_ && fits(*model_) ? *model_ : sensor_msgs::CameraInfo();
  info->header = header;
  info->width = width;
  info->height = height;
  return info;
}

/// The calibration, which is read from the file at the first call; zeros if there is none.
sensor_msgs::CameraInfo Calibration::stored()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!read_) info_ = read();
  read_ = true;
  return info_;
}

sensor_msgs::CameraInfo Calibration::read() const
{
  std::error_code ignored;
  std::string of_camera;
  sensor_msgs::CameraInfo info;
  if (!std::filesystem::exists(path_, ignored))
    ROS_WARN("%s: not calibrated: there is no %s", name_.c_str(), logLine(path_).c_str());
  else
    try
    {
      info = parse(path_, of_camera);
      if (const std::string problem = problemOf(info); !problem.empty())
        throw std::runtime_error(path_ + ": " + problem);
      ROS_INFO("%s: calibrated by %s", name_.c_str(), logLine(path_).c_str());
    }
    catch (const std::exception& e)
    {
      info = {};
      ROS_ERROR("%s: not calibrated: %s", name_.c_str(), logLine(e.what()).c_str());
    }
  if (!of_camera.empty() && of_camera != camera_name_)
    ROS_WARN("%s: %s is of a camera named %s, this one is %s", name_.c_str(), logLine(path_).c_str(),
             printable(of_camera).c_str(), camera_name_.c_str());
  return info;
}

void Calibration::set(const sensor_msgs::CameraInfo& info)
{
  std::unique_lock<std::mutex> lock(mutex_);
  const cv::Size size = size_;
  lock.unlock();  // images must not wait for the disk
  requireUsable(info, size);
  save(info);
  lock.lock();
  info_ = info;
  read_ = true;
}

void Calibration::save(const sensor_msgs::CameraInfo& info) const
{
  const std::filesystem::path path(path_);
  if (path.extension() != ".ini" && path.extension() != ".yaml" && path.extension() != ".yml")
    throw std::runtime_error(path_ + ": the name must end in .yaml, .yml or .ini");
  const std::string text = calibrationText(info, formatOf(path_), camera_name_);
  if (text.empty()) throw std::runtime_error(path_ + ": this format cannot hold the calibration, .yaml can");
  std::filesystem::create_directories(path.parent_path());
  replaceFile(path_, text);
}

bool Calibration::onSet(sensor_msgs::SetCameraInfo::Request& request, sensor_msgs::SetCameraInfo::Response& response)
{
  try
  {
    set(request.camera_info);
    response.success = true;
    response.status_message = path_;
  }
  catch (const std::exception& e)
  {
    response.success = false;
    response.status_message = logLine(e.what());
    ROS_ERROR("%s: the calibration stays as it is: %s", name_.c_str(), response.status_message.c_str());
  }
  return true;
}

}  // namespace robot_vision
