#include "registration.hpp"

#include <ros/connection_manager.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <ros/service_manager.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpc.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "robot_vision/common/shared_instance.hpp"

namespace robot_vision
{
namespace
{

using XmlRpc::XmlRpcValue;
using Names = std::set<std::string>;

constexpr std::chrono::seconds kPeriod(5);            // between two checks of the master
constexpr std::chrono::milliseconds kGathering(500);  // in which a node that is loaded advertises its topics

XmlRpcValue request(const std::vector<XmlRpcValue>& arguments)
{
  XmlRpcValue all;
  all[0] = ros::this_node::getName();
  for (std::size_t i = 0; i < arguments.size(); ++i)
    all[static_cast<int>(i) + 1] = arguments[i];
  return all;
}

/// Calls the master; empty if it does not answer or answers with an error.
std::optional<XmlRpcValue> ask(const char* method, const std::vector<XmlRpcValue>& arguments = {})
{
  XmlRpcValue response;
  XmlRpcValue payload;
  if (!ros::master::execute(method, request(arguments), response, payload, false)) return std::nullopt;
  return payload;
}

std::string uri()
{
  return ros::XMLRPCManager::instance()->getServerURI();
}

/// Calls this process's own XML-RPC interface (Slave API in the ROS wiki); empty if it does not answer any more.
std::optional<XmlRpcValue> askSelf(const char* method, const std::vector<XmlRpcValue>& arguments = {})
{
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri(), host, port)) return std::nullopt;
  const auto manager = ros::XMLRPCManager::instance();
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  XmlRpcValue response;
  XmlRpcValue payload;
  const bool answered = client->execute(method, request(arguments), response);
  manager->releaseXMLRPCClient(client);
  if (!answered || !manager->validateXmlrpcResponse(method, response, payload)) return std::nullopt;
  return payload;
}

/// Registers all publishers. This function and the next two return false if a call of the master failed.
bool registerPublishers()
{
  std::optional<XmlRpcValue> publications = askSelf("getPublications");  // topics and types
  bool all = publications.has_value();
  for (int i = 0; publications && i < publications->size(); ++i)
    all = ask("registerPublisher", {(*publications)[i][0], (*publications)[i][1], uri()}) && all;
  return all;
}

/// The nodes from which this one receives messages, by topic.
std::map<std::string, Names> connectedPublishers()
{
  std::optional<XmlRpcValue> connections = askSelf("getBusInfo");
  std::map<std::string, Names> publishers;
  for (int i = 0; connections && i < connections->size(); ++i)
  {
    XmlRpcValue& connection = (*connections)[i];  // number, peer, direction, transport, topic
    const std::string direction = connection[2];
    const std::string topic = connection[4];
    if (direction == "i") publishers[topic].insert(connection[1]);
  }
  return publishers;
}

bool registerSubscribers()
{
  std::map<std::string, Names> publishers =
      connectedPublishers();  // the update must list them, else they would be dropped
  std::optional<XmlRpcValue> subscriptions = askSelf("getSubscriptions");  // topics and types
  bool complete = subscriptions.has_value();
  for (int i = 0; subscriptions && i < subscriptions->size(); ++i)
  {
    const std::string topic = (*subscriptions)[i][0];
    std::optional<XmlRpcValue> known = ask("registerSubscriber", {topic, (*subscriptions)[i][1], uri()});
    complete = known && complete;
    if (!known) continue;
    for (int n = 0; n < known->size(); ++n)
      publishers[topic].insert((*known)[n]);
    XmlRpcValue all;
    all.setSize(0);
    for (const std::string& publisher : publishers[topic])
      all[all.size()] = publisher;
    askSelf("publisherUpdate", {topic, all});
  }
  return complete;
}

/// Registers services. roscpp cannot list its services, only tell whether one exists, so the names come from the
/// master.
bool registerServices(const Names& names)
{
  const std::uint32_t port = ros::ConnectionManager::instance()->getTCPPort();
  const std::string address = "rosrpc://" + ros::network::getHost() + ":" + std::to_string(port);
  bool all = true;
  for (const std::string& name : names)
    if (ros::ServiceManager::instance()->lookupServicePublication(name))
      all = ask("registerService", {name, address, uri()}) && all;
  return all;
}

std::optional<Names> registeredServices()
{
  std::optional<XmlRpcValue> state = ask("getSystemState");
  if (!state) return std::nullopt;
  Names names;
  XmlRpcValue& services = (*state)[2];  // names and the nodes of each
  for (int i = 0; i < services.size(); ++i)
    for (int n = 0; n < services[i][1].size(); ++n)
    {
      const std::string node = services[i][1][n];
      if (node == ros::this_node::getName()) names.insert(services[i][0]);
    }
  return names;
}

/// Sets those members of `params` that the master does not have.
void setMissing(const std::string& ns, XmlRpcValue params)
{
  if (params.getType() != XmlRpcValue::TypeStruct) return;
  for (const auto& [name, value] : params)
  {
    const std::string key = ns + "/" + name;
    std::optional<XmlRpcValue> has = ask("hasParam", {key});
    if (has && !static_cast<bool>(*has)) ask("setParam", {key, value});
  }
}

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
  Names services_;
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
  std::optional<XmlRpcValue> pid = ask("getPid");
  if (!pid || ros::isShuttingDown()) return;
  // A new master may know the process already, by a topic that was registered with it meanwhile.
  const bool replaced = master_pid_ != 0 && master_pid_ != static_cast<int>(*pid);
  const bool taken = namesAreTaken();
  const bool known = !replaced && complete_ && ask("lookupNode", {ros::this_node::getName()});
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
                       const std::optional<XmlRpcValue> address = ask("lookupNode", {node.first});
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
    if (const std::optional<Names> services = registeredServices())
    {
      services_ = *services;
      topics_ = topics;
    }
  for (auto& [ns, params] : params_)
  {
    std::optional<XmlRpcValue> has = ask("hasParam", {ns});
    if (has && !static_cast<bool>(*has)) params.clear();
    if (const std::optional<XmlRpcValue> present = ask("getParam", {ns})) params = *present;
  }
}

bool Registration::Watch::registerAgain()
{
  ROS_INFO("%s: the master is another one: registering again", ros::this_node::getName().c_str());
  for (const auto& [ns, params] : params_)
    setMissing(ns, params);
  const bool services = registerServices(services_), publishers = registerPublishers();
  return registerSubscribers() && services && publishers;
}

Registration::Registration(const std::string& ns, const std::string& node, const std::string& node_uri)
  : watch_(sharedInstance<Watch>()), ns_(ns)
{
  const std::lock_guard<std::mutex> lock(watch_->mutex_);
  watch_->params_[ns_];
  watch_->nodes_[ros::this_node::getName()] = uri();
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
