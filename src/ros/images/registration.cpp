#include "registration.hpp"

#include <ros/ros.h>
#include <xmlrpcpp/XmlRpc.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "own_registrations.hpp"
#include "robot_vision/common/shared_instance.hpp"

namespace robot_vision
{
namespace
{

using XmlRpc::XmlRpcValue;

constexpr std::chrono::seconds kPeriod(5);            // between two checks of the master
constexpr std::chrono::milliseconds kGathering(500);  // in which a node that is loaded advertises its topics

}  // namespace

/// Checks the master periodically in a thread of its own.
class Registration::Watch
{
public:
  Watch() : thread_(&Watch::run, this) {}
  ~Watch();

private:
  friend class Registration;

  void run();
  void wake(bool& reason);
  void look();
  void lookForServices();
  bool namesAreTaken() const;
  void remember();
  bool registerAgain();

  std::mutex wake_mutex_;  // guards the next three
  std::condition_variable woken_;
  bool end_ = false;
  bool has_services_ = false;  // that were not looked for yet

  std::mutex mutex_;      // guards all below
  int master_pid_ = 0;    // process id of the master that knows this process; 0 if none was seen yet
  bool complete_ = true;  // false if registering again has failed in part
  ServiceNames services_;
  std::vector<std::string> topics_;            // that the process advertised when these were its services
  std::map<std::string, XmlRpcValue> params_;  // by namespace
  std::map<std::string, std::string> nodes_;   // the nodes of this process and their URIs
  std::thread thread_;
};

Registration::Watch::~Watch()
{
  wake(end_);
  thread_.join();
}

void Registration::Watch::wake(bool& reason)
{
  {
    const std::lock_guard<std::mutex> lock(wake_mutex_);
    reason = true;
  }
  woken_.notify_all();
}

void Registration::Watch::run()
{
  std::unique_lock<std::mutex> waking(wake_mutex_);
  while (!end_)
  {
    woken_.wait_for(waking, kPeriod, [this] { return end_ || has_services_; });
    if (has_services_) woken_.wait_for(waking, kGathering, [this] { return end_; });
    if (end_) return;
    const bool has_services = std::exchange(has_services_, false);
    waking.unlock();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (has_services)
        lookForServices();
      else
        look();
    }
    waking.lock();
  }
}

void Registration::Watch::look()
try
{
  std::optional<XmlRpcValue> pid = askMaster("getPid");
  if (!pid || ros::isShuttingDown()) return;
  // A new master may know the process already, by a topic that was registered with it meanwhile.
  const bool replaced = master_pid_ != 0 && master_pid_ != static_cast<int>(*pid);
  const bool taken = namesAreTaken();
  // One in a container may have the process id of the one before: this service is registered once, by ros::start().
  const bool known = !replaced && complete_ && askMaster("lookupService", {ros::this_node::getName() + "/get_loggers"});
  if (ros::isShuttingDown()) return;  // then calls are not answered, not even by this process
  if (taken)
  {
    if (replaced)  // roscpp's log would call the master for a parameter, and so register this node
      std::cerr << ros::this_node::getName()
                << ": the master is another one, and knows another node of this name: not registered again\n";
    complete_ = false;
  }
  else if (known)
    remember();
  else
    complete_ = registerAgain();
  master_pid_ = *pid;
}
catch (const XmlRpc::XmlRpcException& e)  // an answer had an unexpected type
{
  ROS_WARN("%s: not registered again: %s", ros::this_node::getName().c_str(), e.getMessage().c_str());
}

/// Looks, and asks for services also if there are no new topics.
void Registration::Watch::lookForServices()
{
  topics_.clear();
  look();
}

bool Registration::Watch::namesAreTaken() const
{
  return std::any_of(nodes_.begin(), nodes_.end(),
                     [](const auto& node)
                     {
                       const std::optional<XmlRpcValue> address = askMaster("lookupNode", {node.first});
                       return address && static_cast<std::string>(*address) != node.second;
                     });
}

void Registration::Watch::remember()
{
  // Services come with topics. The master tells of those of all nodes at once, which takes the more the larger the
  // system is, so it is asked when there is something new.
  std::vector<std::string> topics;
  ros::this_node::getAdvertisedTopics(topics);
  if (topics != topics_)
    if (const std::optional<ServiceNames> services = registeredServices())
    {
      services_ = *services;
      topics_ = topics;
    }
  for (auto& [ns, params] : params_)
  {
    std::optional<XmlRpcValue> has = askMaster("hasParam", {ns});
    if (has && !static_cast<bool>(*has)) params.clear();
    if (const std::optional<XmlRpcValue> present = askMaster("getParam", {ns})) params = *present;
  }
}

bool Registration::Watch::registerAgain()
{
  ROS_INFO("%s: the master is another one: registering again", ros::this_node::getName().c_str());
  for (const auto& [ns, params] : params_)
    setMissingParams(ns, params);
  const bool services = registerServices(services_), publishers = registerPublishers();
  return registerSubscribers() && services && publishers;
}

Registration::Registration(const std::string& ns, const std::string& node, const std::string& node_uri)
  : watch_(sharedInstance<Watch>()), ns_(ns)
{
  const std::lock_guard<std::mutex> lock(watch_->mutex_);
  watch_->params_[ns_];
  watch_->nodes_[ros::this_node::getName()] = ownUri();
  if (!node.empty()) watch_->nodes_[node] = node_uri;
  watch_->lookForServices();
}

Registration::~Registration()
{
  const std::lock_guard<std::mutex> lock(watch_->mutex_);
  watch_->params_.erase(ns_);
}

void Registration::noteServices()
{
  watch_->wake(watch_->has_services_);
}

}  // namespace robot_vision
