#pragma once

#include <dynamic_reconfigure/Config.h>
#include <ros/ros.h>

#include <string>

#include "params.hpp"

namespace robot_vision
{

/// Puts what `config` has under `name` into `value`, if it has it.
void takeValue(const dynamic_reconfigure::Config& config, const std::string& name, bool& value);
void takeValue(const dynamic_reconfigure::Config& config, const std::string& name, int& value);
void takeValue(const dynamic_reconfigure::Config& config, const std::string& name, double& value);
void takeValue(const dynamic_reconfigure::Config& config, const std::string& name, std::string& value);

/// Params of the core (see fields.hpp there) with what `config` has under the names of their fields. `Config` is
/// generated from a .cfg file.
template <class Params, class Config>
Params filled(const Config& config)
{
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  Params params;
  Params::fields([&](const char* name, auto member, const auto& /*limits*/, const char* /*unit*/,
                     const char* /*meaning*/) { takeValue(message, name, params.*member); });
  return params;
}

/// Reads the fields of Params of the core that are on the parameter server, as readParam does.
template <class Params>
void readFields(const ros::NodeHandle& nh, Params& params)
{
  Params::fields([&](const char* name, auto member, const auto& /*limits*/, const char* /*unit*/,
                     const char* /*meaning*/) { readParam(nh, name, params.*member); });
}

}  // namespace robot_vision
