#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// Sets the controls of a device as it is told at first and, live, as a dynamic_reconfigure
/// server below ~controls, which describes the controls of the camera that is plugged in. Thread-safe.
class ControlServer
{
public:
  using Open = std::function<std::unique_ptr<FrameSource>()>;

  ControlServer(const ros::NodeHandle& pnh, ControlDevice port, const std::vector<ControlSetting>& settings);

  /// Opens the camera, perhaps another one, to stream from, and sets again all that has been set before. Meanwhile no
  /// service has it open: some drivers allow no second opening.
  std::unique_ptr<FrameSource> open(const Open& open_source);

  /// What has been set, under the camera's own names.
  dynamic_reconfigure::Config settings();

private:
  void restore(V4l2Device& device);
  void list(V4l2Device& device);
  void remember(const ControlSetting& setting);
  bool change(dynamic_reconfigure::Reconfigure::Request& request, dynamic_reconfigure::Reconfigure::Response& response);

  std::string name_;
  std::mutex mutex_;  // guards all below: the capture thread and the service's meet here
  ControlDevice port_;
  std::vector<CameraControl> controls_;
  std::vector<ControlSetting> settings_;
  std::set<std::string> told_;  // what could not be restored is told once
  ros::Publisher descriptions_;
  ros::Publisher values_;
  ros::ServiceServer service_;
};

}  // namespace robot_vision
