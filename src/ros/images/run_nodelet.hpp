#pragma once

#include <nodelet/nodelet.h>

#include <boost/shared_ptr.hpp>

#include <functional>
#include <string>

namespace robot_vision
{

/// Runs one nodelet as a node of its own until SIGINT, SIGTERM, ros::requestShutdown() or endNode(); to be returned
/// from main(). 0 in these cases, also while it still waits for the master, or endNode()'s code; 1 if the nodelet's
/// start failed (it has logged why).
/// With --help it prints what the node is `about` (lines: topics and services), and needs no master.
int runNodelet(int argc, char** argv, const std::string& name, const std::string& about,
               const std::function<boost::shared_ptr<nodelet::Nodelet>()>& make);

/// Ends the node that runNodelet() runs, from any thread.
void endNode(int code);

}  // namespace robot_vision
