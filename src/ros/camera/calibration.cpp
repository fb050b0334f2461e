#include "calibration.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "calibration_file.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "ros/images/bounded_reading.hpp"
#include "ros/images/camera_info.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxName = 200;  // bytes, because it is part of a file's name

bool isName(const std::string& text)
{
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !text.empty() && text.size() <= kMaxName && std::all_of(text.begin(), text.end(), fits);
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
  validate(cameraModel(info));
  validateRectification(cv::Matx33d(info.R.data()), cv::Matx34d(info.P.data()));
}

}  // namespace

Calibration::Calibration(const ros::NodeHandle& pnh, const std::string& camera_name, const std::string& url)
  : name_(pnh.getNamespace()), camera_name_(camera_name), has_url_(!url.empty())
{
  require(isName(camera_name), "camera_name", "'" + camera_name + "'",
          "letters, digits and _, " + std::to_string(kMaxName) + " at most");
  path_ = calibrationPath(url, camera_name);
  auto service = boundedService<sensor_msgs::SetCameraInfo>(
      "set_camera_info", [this](auto& request, auto& response) { return onSet(request, response); });
  service_ = ros::NodeHandle(pnh).advertiseService(service);
}

void Calibration::setModel(std::unique_ptr<sensor_msgs::CameraInfo> model, bool exact)
{
  model_ = std::move(model);
  exact_ = exact;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_fixed_ = model_ && exact_ && !has_url_;
  }
  if (!model_) return;
  setImageSize({static_cast<int>(model_->width), static_cast<int>(model_->height)});
  if (!exact_)
    ROS_INFO("%s: unless it is calibrated, camera_info is what is usual for such cameras", name_.c_str());
  else if (has_url_)
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
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(model_ && exact_ && !has_url_ ? *model_ : stored());
  const bool calibrated = info->K[0] != 0.0;
  if (calibrated && !fits(*info) && wrong_size_.due())
    ROS_WARN("%s: the calibration is for %ux%u, the image has %ux%u: it is not used", name_.c_str(), info->width,
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
  if (!std::filesystem::exists(path_, ignored))
  {
    ROS_WARN("%s: not calibrated: there is no %s", name_.c_str(), logLine(path_).c_str());
    return {};
  }
  std::string problem;
  std::string of_camera;
  sensor_msgs::CameraInfo info;
  try
  {
    info = readCalibration(path_, of_camera);
    requireUsable(info, {});
    ROS_INFO("%s: calibrated by %s", name_.c_str(), logLine(path_).c_str());
  }
  catch (const std::invalid_argument& e)
  {
    problem = path_ + ": " + e.what();
  }
  catch (const std::exception& e)
  {
    problem = e.what();
  }
  if (!problem.empty()) ROS_ERROR("%s: not calibrated: %s", name_.c_str(), logLine(problem).c_str());
  if (!of_camera.empty() && of_camera != camera_name_)
    ROS_WARN("%s: %s is of a camera named %s, this one is %s", name_.c_str(), logLine(path_).c_str(),
             printable(of_camera).c_str(), camera_name_.c_str());
  return problem.empty() ? info : sensor_msgs::CameraInfo();
}

void Calibration::set(const sensor_msgs::CameraInfo& info)
{
  std::unique_lock<std::mutex> lock(mutex_);
  // The file of this name may be a real camera's.
  if (is_fixed_)
    throw std::invalid_argument("camera_info is the scene's own, exact: camera_info_url must name a file for another");
  const cv::Size size = size_;
  lock.unlock();  // images must not wait for the disk
  requireUsable(info, size);
  writeCalibration(path_, info, camera_name_);
  lock.lock();
  info_ = info;
  read_ = true;
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
