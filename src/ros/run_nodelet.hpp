#pragma once

#include <nodelet/nodelet.h>

#include <boost/shared_ptr.hpp>

#include <functional>
#include <string>

namespace robot_vision
{

/// Runs one nodelet as a node of its own until SIGINT, SIGTERM or ros::requestShutdown(); to be returned from main().
/// 0 in these cases, also while it still waits for the master; 1 if the nodelet's start failed (it has logged why).
/// With --help it prints what the node is `about` (lines: topics and services), and needs no master.
int runNodelet(int argc, char** argv, const std::string& name, const std::string& about,
               const std::function<boost::shared_ptr<nodelet::Nodelet>()>& make);

}  // namespace robot_vision
