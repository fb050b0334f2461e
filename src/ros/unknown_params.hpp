#pragma once

#include <ros/ros.h>

#include <string>

namespace robot_vision
{

/// Remembers that the node of this namespace has a parameter `name`.
void noteKnownParam(const ros::NodeHandle& nh, const std::string& name);

/// Warns of parameters of a node that have not been noted: they may be misspelt. Maps are left out, which are names of
/// other nodes and transports, too. To be called when the node has read all that it reads at start.
void warnOfUnknownParams(const ros::NodeHandle& nh);

}  // namespace robot_vision
