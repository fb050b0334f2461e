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

/// Sets the controls of a device: at first to the given settings, then live as a dynamic_reconfigure server below
/// ~controls, which describes the controls of the present camera. Thread-safe.
class ControlServer
{
public:
  using Open = std::function<std::unique_ptr<FrameSource>()>;

  ControlServer(const ros::NodeHandle& pnh, ControlDevice control_device, const std::vector<ControlSetting>& settings);

  /// Opens the camera for streaming and restores all settings; it may be another camera than before. The service does
  /// not have the camera open meanwhile, because some drivers cannot be opened twice.
  std::unique_ptr<FrameSource> open(const Open& open_source);

  /// The settings made so far, without implied ones that the camera has no control for: under the camera's own names,
  /// but for those that have another one to be saved as.
  dynamic_reconfigure::Config settings();

private:
  void restore(V4l2Device& device);
  void list(V4l2Device& device);
  void remember(const ControlSetting& setting);
  bool change(dynamic_reconfigure::Reconfigure::Request& request, dynamic_reconfigure::Reconfigure::Response& response);

  std::string name_;
  std::mutex mutex_;  // guards all below, which the capture thread and the service use
  ControlDevice control_device_;
  std::vector<CameraControl> controls_;
  std::vector<ControlSetting> settings_;
  std::set<std::string> reported_;  // errors of restoring, each of which is logged once
  ros::Publisher descriptions_;
  ros::Publisher values_;
  ros::ServiceServer service_;
};

}  // namespace robot_vision
