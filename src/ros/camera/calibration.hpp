#pragma once

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/SetCameraInfo.h>

#include <mutex>
#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// A camera's calibration: the file that it is in, as camera_info_manager and camera_calibration have it, and the
/// service ~set_camera_info. Unlike that of camera_info_manager it takes no calibration that cannot be the camera's,
/// and replaces the file in one step or not at all.
class Calibration
{
public:
  /// `url` is file:///... or package://..., with ${NAME} and ${ROS_HOME} in it replaced; empty: it is the file
  /// camera_info/${NAME}.yaml in ${ROS_HOME}. Throws std::invalid_argument naming camera_name or camera_info_url.
  Calibration(const ros::NodeHandle& pnh, const std::string& camera_name, const std::string& url);

  /// Read from the file when it is first asked for; zeros if there is none.
  sensor_msgs::CameraInfo info();

  /// The size of the camera's pictures. Until it is known a calibration may be of any.
  void setPictureSize(cv::Size size);

private:
  sensor_msgs::CameraInfo read() const;
  void set(const sensor_msgs::CameraInfo& info);
  void save(const sensor_msgs::CameraInfo& info) const;
  bool onSet(sensor_msgs::SetCameraInfo::Request& request, sensor_msgs::SetCameraInfo::Response& response);

  std::string name_;  // of the node, for what is logged
  std::string camera_name_;
  std::string path_;
  std::mutex mutex_;  // guards all below: the service's thread is not that of pictures
  bool read_ = false;
  sensor_msgs::CameraInfo info_;
  cv::Size size_;
  ros::ServiceServer service_;
};

}  // namespace robot_vision
