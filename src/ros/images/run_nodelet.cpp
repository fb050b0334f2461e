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

void onSignal(int)
{
  sem_post(&signalled);  // all else is too much for a signal handler
}

/// From now on a signal ends the process within a second, whatever blocks its threads. roscpp would shut down in a
/// thread of its own, beside a callback under way that uses it; here main() does once that has returned.
void endOnSignals()
{
  sem_init(&signalled, 0, 0);
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  std::thread(
      []
      {
        while (sem_wait(&signalled) != 0)
          ;  // another signal has come
        // ros::init() waits for the master deaf to shutdown requests, if it has parameters to set; the master knows
        // nothing of this node yet.
        if (!initialized) std::_Exit(0);
        interrupted = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        ros::requestShutdown();  // frees a thread that waits for the master
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        std::_Exit(exit_code);
      })
      .detach();
}

/// ros::start() would wait for the master just as deaf. False if a signal came first.
bool waitForMaster()
{
  for (bool said = false; !interrupted && !ros::master::check(); said = true)
  {
    if (!said) ROS_WARN("waiting for the master at %s", ros::master::getURI().c_str());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return !interrupted;
}

/// A driver or server that blocks a thread must not hold up the end of the process.
void endWithinASecond()
{
  std::thread(
      []
      {
        std::this_thread::sleep_for(std::chrono::milliseconds(800));
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
         "\nIts parameters are described in docs/parameters.md of this package; its folder config has a file of\n"
         "them, where ~save_parameters (std_srvs/Trigger) saves those that can be changed live.\n";
}

void initAndSpin(nodelet::Nodelet& nodelet, const nodelet::V_string& arguments)
{
  try
  {
    nodelet.init(ros::this_node::getName(), ros::names::getRemappings(), arguments);
  }
  catch (const std::exception&)  // the nodelet has logged it
  {
    if (!interrupted) exit_code = 1;
    return;
  }
  try
  {
    // While it shuts down roscpp is still ok(): it waits for the master, which may not answer.
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
  catch (const std::exception& e)  // of a user for whom no folder can be made
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
