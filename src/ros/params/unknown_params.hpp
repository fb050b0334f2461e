#pragma once

#include <ros/ros.h>

#include <string>

namespace robot_vision
{

/// Notes that the node of this namespace has a parameter `name`. `changed` is its value as text if it differs from the
/// default.
void noteKnownParam(const ros::NodeHandle& nh, const std::string& name, const std::string& changed = "");

/// Logs in one line which parameters of a node differ from their defaults, because another run may have left them.
/// Warns of parameters that were not noted, because they may be misspelt, except for maps with the name of a transport
/// or of the namespace of a node, topic or service. To be called when the node has read all parameters that it reads at
/// start and has advertised its topics.
void reviewParams(const ros::NodeHandle& nh);

}  // namespace robot_vision
