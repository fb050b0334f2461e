#include "run_nodelet.hpp"

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <semaphore.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <thread>

namespace robot_vision
{
namespace
{

std::atomic<bool> interrupted{false};
std::atomic<bool> initialized{false};
std::atomic<bool> ended{false};  // by the node itself
std::atomic<int> exit_code{0};

sem_t signalled;

/// Waits for this many tenths of a second. The time in which the process is stopped does not count.
void waitTenths(int count)
{
  for (int i = 0; i < 2 * count; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

void onSignal(int)
{
  sem_post(&signalled);  // a signal handler may do little else
}

/// From now on a signal ends the process within a second, whatever blocks its threads. roscpp's own handler would shut
/// roscpp down in another thread while a callback may still use it; here main() does so after the callback.
void endOnSignals()
{
  sem_init(&signalled, 0, 0);
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  std::thread(
      []
      {
        while (sem_wait(&signalled) != 0)
          ;  // interrupted by another signal
        // If ros::init() has parameters to set, it waits for the master and ignores shutdown requests. The master does
        // not know this node yet.
        if (!initialized) std::_Exit(0);
        interrupted = true;
        waitTenths(3);
        ros::requestShutdown();  // ends the wait of a thread for the master
        waitTenths(5);
        std::_Exit(exit_code);
      })
      .detach();
}

/// Waits for the master, because ros::start() would do so without reacting to signals. Returns false after a signal.
bool waitForMaster()
{
  for (bool warned = false; !interrupted && !ros::master::check(); warned = true)
  {
    if (!warned) ROS_WARN("waiting for the master at %s", ros::master::getURI().c_str());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return !interrupted;
}

/// Ends the process within a second even if a driver or server blocks a thread.
void endWithinASecond()
{
  std::thread(
      []
      {
        waitTenths(8);
        std::_Exit(exit_code);
      })
      .detach();
}

bool asksForHelp(int argc, char** argv)
{
  return std::any_of(argv + 1, argv + argc, [](const std::string& word) { return word == "-h" || word == "--help"; });
}

std::string usage(const std::string& name, const std::string& about)
{
  return "usage: rosrun robot_vision " + name + "_node [TOPIC:=OTHER ...] [_PARAMETER:=VALUE ...]\n\n" + about +
         "\ndocs/parameters.md of this package describes the parameters. A file in its folder config has their "
         "defaults;\n"
         "~save_parameters (std_srvs/Trigger) saves those that can be changed live in the file ~config_file.\n";
}

void initAndSpin(nodelet::Nodelet& nodelet, const nodelet::V_string& arguments)
{
  try
  {
    nodelet.init(ros::this_node::getName(), ros::names::getRemappings(), arguments);
  }
  catch (const std::exception&)  // the nodelet has logged the error
  {
    if (!interrupted) exit_code = 1;
    return;
  }
  try
  {
    // ros::ok() is still true while roscpp shuts down and waits for a master that may not answer.
    while (ros::ok() && !ros::isShuttingDown() && !interrupted && !ended)
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s: %s", ros::this_node::getName().c_str(), e.what());
    exit_code = 1;
  }
}

}  // namespace

int runNodelet(int argc, char** argv, const std::string& name, const std::string& about,
               const std::function<boost::shared_ptr<nodelet::Nodelet>()>& make)
{
  if (asksForHelp(argc, argv))
  {
    std::cout << usage(name, about);
    return 0;
  }
  endOnSignals();
  try
  {
    ros::init(argc, argv, name, ros::init_options::NoSigintHandler);
  }
  catch (const std::exception& e)  // such as a user for whom ~/.ros cannot be made
  {
    ROS_FATAL("%s: %s; ROS_HOME names a folder that this user may write to", name.c_str(), e.what());
    return 1;
  }
  initialized = true;
  if (!waitForMaster()) return 0;
  ros::start();
  boost::shared_ptr<nodelet::Nodelet> nodelet = make();
  initAndSpin(*nodelet, nodelet::V_string(argv + 1, argv + argc));
  endWithinASecond();
  nodelet.reset();
  ros::shutdown();
  return exit_code;
}

void endNode(int code)
{
  exit_code = code;
  ended = true;
}

}  // namespace robot_vision
