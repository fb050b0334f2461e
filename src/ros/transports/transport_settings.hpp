#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>

#include <boost/thread/recursive_mutex.hpp>
#include <mutex>
#include <stdexcept>

#include "ros/images/callback_gate.hpp"
#include "ros/params/whole_config.hpp"

namespace robot_vision
{

/// The settings of one topic's transport, live through dynamic_reconfigure in the topic's namespace: those of
/// <topic>/compressed are at <topic>/compressed/set_parameters. `to_params` converts the generated Config, or throws
/// std::invalid_argument; then the old settings stay.
template <class Config, class Params>
class TransportSettings
{
public:
  using ToParams = Params (*)(const Config&);

  TransportSettings(ros::NodeHandle nh, ToParams to_params)
    : name_(nh.getNamespace()), to_params_(to_params), server_(guarded(nh))
  {
    server_.setCallback([this](Whole& config, std::uint32_t) { change(config); });
  }

  ~TransportSettings() { gate_.close(); }

  Params params() const
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return params_;
  }

private:
  using Whole = WholeConfig<Config, readFittingParams>;

  const ros::NodeHandle& guarded(ros::NodeHandle& nh)
  {
    gate_.guard(nh);
    return nh;
  }

  void change(Config& config)
  {
    try
    {
      const Params params = to_params_(config);
      const std::lock_guard<std::mutex> lock(mutex_);
      params_ = params;
      config_ = config;
    }
    catch (const std::invalid_argument& e)
    {
      ROS_WARN("%s: refused, the parameters stay as they are: %s", name_.c_str(), e.what());
      config = config_;
    }
  }

  CallbackGate gate_;
  std::string name_;
  ToParams to_params_;
  mutable std::mutex mutex_;  // guards params_, because publishing and reconfiguring may be in different threads
  Params params_;
  Config config_ = Config::__getDefault__();
  dynamic_reconfigure::Server<Whole> server_;
};

}  // namespace robot_vision
