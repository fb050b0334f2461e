#pragma once

#include <ros/ros.h>

#include <string>

namespace robot_vision
{

/// Remembers that the node of this namespace has a parameter `name`; `changed` is its value as text if that is not the
/// default.
void noteKnownParam(const ros::NodeHandle& nh, const std::string& name, const std::string& changed = "");

/// Says in one line which parameters of a node are not at their defaults: they may have been left by another run. Warns
/// of those that have not been noted: they may be misspelt. Of these maps are left out that are named as a transport,
/// or as the namespace of a node, topic or service. To be called when the node has read all that it reads at start, and
/// has advertised its topics.
void reviewParams(const ros::NodeHandle& nh);

}  // namespace robot_vision
