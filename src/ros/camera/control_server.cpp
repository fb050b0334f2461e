#include "control_server.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "control_messages.hpp"
#include "robot_vision/common/printable.hpp"
#include "ros/images/bounded_reading.hpp"

namespace robot_vision
{

ControlServer::ControlServer(const ros::NodeHandle& pnh, ControlDevice control_device,
                             const std::vector<ControlSetting>& settings)
  : name_(pnh.getNamespace()), control_device_(std::move(control_device))
{
  for (const ControlSetting& setting : settings)
    remember(setting);
  ros::NodeHandle nh(pnh, "controls");
  descriptions_ = nh.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  values_ = nh.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
  auto service = boundedService<dynamic_reconfigure::Reconfigure>(
      "set_parameters", [this](auto& request, auto& response) { return change(request, response); });
  service_ = nh.advertiseService(service);
}

std::unique_ptr<FrameSource> ControlServer::open(const Open& open_source)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std::unique_ptr<FrameSource> source = open_source();
  control_device_.follow(*source);
  if (const std::shared_ptr<V4l2Device> device = source->device()) restore(*device);
  return source;
}

void ControlServer::restore(V4l2Device& device)
try
{
  if (!settings_.empty())
    for (const RefusedSetting& refused : setControls(device, settings_))
      if (reported_.insert(refused.reason).second) ROS_WARN("%s: %s", name_.c_str(), logLine(refused.reason).c_str());
  list(device);
  descriptions_.publish(toDescription(controls_));
}
catch (const SourceUnavailable&)  // the device is gone again, which the capture will notice
{
}

void ControlServer::list(V4l2Device& device)
{
  controls_ = listControls(device);
  values_.publish(toConfig(controls_));
}

/// Stores a setting in place of an earlier one of the same control, whatever name that one used.
void ControlServer::remember(const ControlSetting& setting)
{
  const CameraControl* control = findControl(controls_, setting.name);
  const auto differs = [&](const ControlSetting& other)
  { return other.name != setting.name && (control == nullptr || findControl(controls_, other.name) != control); };
  const auto replaced = std::stable_partition(settings_.begin(), settings_.end(), differs);
  std::string saved_as = setting.saved_as;
  for (auto other = replaced; other != settings_.end() && saved_as.empty(); ++other)
    saved_as = other->saved_as;
  settings_.erase(replaced, settings_.end());
  settings_.push_back({control == nullptr ? setting.name : control->name, setting.value, setting.is_implied, saved_as});
}

dynamic_reconfigure::Config ControlServer::settings()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::vector<ControlSetting> settings = settings_;
  for (const ControlSetting& setting : settings)
    remember(setting);
  std::vector<ControlSetting> made;
  const auto is_made = [this](const ControlSetting& setting)
  { return !setting.is_implied || findControl(controls_, setting.name) != nullptr; };
  std::copy_if(settings_.begin(), settings_.end(), std::back_inserter(made), is_made);
  for (ControlSetting& setting : made)
    if (!setting.saved_as.empty()) setting.name = setting.saved_as;
  return toConfig(made);
}

bool ControlServer::change(dynamic_reconfigure::Reconfigure::Request& request,
                           dynamic_reconfigure::Reconfigure::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  try
  {
    const std::shared_ptr<V4l2Device> device = control_device_.device();
    list(*device);
    const std::vector<ControlSetting> asked = changes(controls_, request.config);
    const std::vector<RefusedSetting> refused = setControls(*device, asked);
    for (const ControlSetting& setting : asked)
    {
      const auto same = [&setting](const RefusedSetting& other) { return other.name == setting.name; };
      const CameraControl* control = findControl(controls_, setting.name);
      // The driver may have failed to describe one that it then set.
      const bool is_button = control != nullptr && control->kind == ControlKind::kButton;
      if (std::any_of(refused.begin(), refused.end(), same) || is_button) continue;
      remember(setting);
    }
    for (const RefusedSetting& setting : refused)
      ROS_WARN("%s: refused: %s", name_.c_str(), logLine(setting.reason).c_str());
    list(*device);
  }
  catch (const SourceUnavailable& e)
  {
    ROS_WARN("%s: the controls stay as they are: %s", name_.c_str(), logLine(e.what()).c_str());
  }
  response.config = toConfig(controls_);
  return true;
}

}  // namespace robot_vision
