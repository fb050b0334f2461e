#pragma once

#include <dynamic_reconfigure/Config.h>
#include <ros/ros.h>

#include <string>

namespace robot_vision
{

/// A parameter's value for a line of a log: as its YAML shows it, or as much of it as fits.
std::string valueText(const XmlRpc::XmlRpcValue& value);

/// Reads `name` of the parameter server into `value` if it is there. Throws std::invalid_argument naming the parameter,
/// its value and the type expected if it is of another type; an integer is accepted for a double.
void readParam(const ros::NodeHandle& nh, const std::string& name, bool& value);
void readParam(const ros::NodeHandle& nh, const std::string& name, int& value);
void readParam(const ros::NodeHandle& nh, const std::string& name, double& value);
void readParam(const ros::NodeHandle& nh, const std::string& name, std::string& value);

/// Reads every value of `config` anew, by name, as readParam does.
void readParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config& config);

}  // namespace robot_vision
