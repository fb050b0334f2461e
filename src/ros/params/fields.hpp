#pragma once

#include <dynamic_reconfigure/config_tools.h>
#include <ros/ros.h>

#include "params.hpp"

namespace robot_vision
{

/// Params of the core (see fields.hpp there) with what `config` has under the names of their fields. `Config` is
/// generated from a .cfg file.
template <class Params, class Config>
Params filled(const Config& config)
{
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  Params params;
  Params::fields(
      [&](const char* name, auto member, const auto& /*limits*/, const char* /*unit*/, const char* /*meaning*/)
      { dynamic_reconfigure::ConfigTools::getParameter(message, name, params.*member); });
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
