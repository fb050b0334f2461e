#pragma once

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <std_msgs/Header.h>

#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/throttle.hpp"

namespace robot_vision
{

/// A camera's calibration: its file, in the format of camera_info_manager and camera_calibration, and the service
/// ~set_camera_info. Unlike camera_info_manager it refuses calibrations that cannot be the camera's, and replaces the
/// file in one step or not at all. The exact model of a source takes the place of a file that no url names; a model
/// that is only that of its make stands in for a file that is not there. None can be set while an
/// exact one is in use.
class Calibration
{
public:
  /// `url` is file:///... or package://...; ${NAME} and ${ROS_HOME} are replaced in it. If it is empty, the file is
  /// ${ROS_HOME}/camera_info/${NAME}.yaml. Throws std::invalid_argument naming camera_name or camera_info_url.
  Calibration(const ros::NodeHandle& pnh, const std::string& camera_name, const std::string& url);

  /// Sets the calibration that the source knows, which is exact or that of its make; null if it knows none.
  void setModel(std::unique_ptr<sensor_msgs::CameraInfo> model, bool exact = true);

  /// Sets the size of the camera's images. Until it is known, calibrations of any size are accepted.
  void setImageSize(cv::Size size);

  /// The camera_info of an image of this size; without a calibration for this size, all else in it is 0.
  sensor_msgs::CameraInfoPtr info(cv::Size size, const std_msgs::Header& header);

private:
  sensor_msgs::CameraInfo stored();
  sensor_msgs::CameraInfo read() const;
  void set(const sensor_msgs::CameraInfo& info);
  bool onSet(sensor_msgs::SetCameraInfo::Request& request, sensor_msgs::SetCameraInfo::Response& response);

  std::string name_;  // of the node, for log lines
  std::string camera_name_;
  std::string path_;
  bool has_url_;
  std::unique_ptr<sensor_msgs::CameraInfo> model_;
  bool exact_ = true;  // whether the model is
  Throttle wrong_size_;
  std::mutex mutex_;       // guards all below, which the threads of the service and of the images use
  bool is_fixed_ = false;  // by a source that is exact, and whose calibration no url replaces
  bool read_ = false;
  sensor_msgs::CameraInfo info_;
  cv::Size size_;
  ros::ServiceServer service_;
};

}  // namespace robot_vision
