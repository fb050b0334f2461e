#pragma once

#include <nodelet/nodelet.h>

#include <boost/shared_ptr.hpp>

#include <functional>
#include <string>

namespace robot_vision
{

/// Runs one nodelet as a node of its own until SIGINT, SIGTERM, ros::requestShutdown() or endNode(), and returns the
/// exit code for main(): 0 (also while it still waits for the master), the code of endNode(), or 1 if the start of the
/// nodelet failed, which it has logged. With --help it prints `about`, the lines about topics and services, and needs
/// no master.
int runNodelet(int argc, char** argv, const std::string& name, const std::string& about,
               const std::function<boost::shared_ptr<nodelet::Nodelet>()>& make);

/// Ends the node that runNodelet() runs, from any thread.
void endNode(int code);

}  // namespace robot_vision
