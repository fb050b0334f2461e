#pragma once

#include <dynamic_reconfigure/Config.h>
#include <ros/ros.h>

#include <string>

namespace robot_vision
{

/// A parameter's value for a log line: as in YAML, shortened if it is long.
std::string valueText(const XmlRpc::XmlRpcValue& value);

/// Reads the parameter `name` into `value`, a bool, int, double or std::string, if it is on the parameter server.
/// Throws std::invalid_argument naming the parameter, its value and the expected type if it has another type; an
/// integer is accepted for a double.
template <class T>
void readParam(const ros::NodeHandle& nh, const std::string& name, T& value);

/// Reads all values of `config` by their names, as readParam() does.
void readParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config& config);

/// Reads those that have the right type, as dynamic_reconfigure does; the others stay as they are.
void readFittingParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config& config);

/// Puts all values of `config` on the parameter server that it does not have yet.
void writeParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config config);

}  // namespace robot_vision
