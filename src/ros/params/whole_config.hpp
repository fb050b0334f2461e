#pragma once

#include <dynamic_reconfigure/Config.h>
#include <ros/ros.h>

#include "params.hpp"

namespace robot_vision
{

/// A `Config`, generated from a .cfg file, for a dynamic_reconfigure::Server that asks the master about all values at
/// once, not about each of them. `read` is readParams or readFittingParams.
template <class Config, void (*read)(const ros::NodeHandle&, dynamic_reconfigure::Config&)>
struct WholeConfig : Config
{
  WholeConfig() : Config(Config::__getDefault__()) {}
  WholeConfig(const Config& config) : Config(config) {}  // NOLINT: the server relies on the conversion

  void __fromServer__(const ros::NodeHandle& nh)
  {
    dynamic_reconfigure::Config message;
    this->__toMessage__(message);
    read(nh, message);
    this->__fromMessage__(message);
  }

  void __toServer__(const ros::NodeHandle& nh) const
  {
    dynamic_reconfigure::Config message;
    this->__toMessage__(message);
    writeParams(nh, message);
  }
};

}  // namespace robot_vision
