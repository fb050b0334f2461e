#include "own_registrations.hpp"

#include <ros/connection_manager.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <ros/service_manager.h>
#include <ros/xmlrpc_manager.h>

#include <boost/algorithm/string/predicate.hpp>
#include <cstdint>
#include <map>
#include <utility>

namespace robot_vision
{
namespace
{

using XmlRpc::XmlRpcValue;

XmlRpcValue request(const std::vector<XmlRpcValue>& arguments)
{
  XmlRpcValue all;
  all[0] = ros::this_node::getName();
  for (std::size_t i = 0; i < arguments.size(); ++i)
    all[static_cast<int>(i) + 1] = arguments[i];
  return all;
}

/// Calls this process's own XML-RPC interface (Slave API in the ROS wiki); empty if it does not answer any more.
std::optional<XmlRpcValue> askSelf(const char* method, const std::vector<XmlRpcValue>& arguments = {})
{
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(ownUri(), host, port)) return std::nullopt;
  const auto manager = ros::XMLRPCManager::instance();
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  XmlRpcValue response;
  XmlRpcValue payload;
  const bool answered = client->execute(method, request(arguments), response);
  manager->releaseXMLRPCClient(client);
  if (!answered || !manager->validateXmlrpcResponse(method, response, payload)) return std::nullopt;
  return payload;
}

/// The nodes from which this one receives messages, by topic.
std::map<std::string, std::set<std::string>> connectedPublishers()
{
  std::optional<XmlRpcValue> connections = askSelf("getBusInfo");
  std::map<std::string, std::set<std::string>> publishers;
  for (int i = 0; connections && i < connections->size(); ++i)
  {
    XmlRpcValue& connection = (*connections)[i];  // number, peer, direction, transport, topic
    const std::string direction = connection[2];
    const std::string topic = connection[4];
    if (direction == "i") publishers[topic].insert(connection[1]);
  }
  return publishers;
}

/// Registers a subscriber, and tells this process of the publishers that the master knows. `connected`, those that it
/// has already, are told again, else it would drop them. The master tells of one that comes meanwhile, perhaps before
/// its older answer is told, which has the process drop that one: so it is asked until its answer stays the same.
bool registerSubscriber(const std::string& topic, const std::string& type, const std::set<std::string>& connected)
{
  for (std::optional<std::set<std::string>> told;;)
  {
    std::optional<XmlRpcValue> known = askMaster("registerSubscriber", {topic, type, ownUri()});
    if (!known) return false;
    std::set<std::string> publishers = connected;
    for (int i = 0; i < known->size(); ++i)
      publishers.insert((*known)[i]);
    if (publishers == told) return true;
    XmlRpcValue all;
    all.setSize(0);
    for (const std::string& publisher : publishers)
      all[all.size()] = publisher;
    askSelf("publisherUpdate", {topic, all});
    told = std::move(publishers);
  }
}

/// What the services of dynamic_reconfigure in this process are named, of which each comes with a topic. The master may
/// not have been asked for services since a transport began one.
ServiceNames reconfigureServices()
{
  const std::string topic_ending = "/parameter_updates";
  std::vector<std::string> topics;
  ros::this_node::getAdvertisedTopics(topics);
  ServiceNames names;
  for (const std::string& topic : topics)
    if (boost::algorithm::ends_with(topic, topic_ending))
      names.insert(topic.substr(0, topic.size() - topic_ending.size()) + "/set_parameters");
  return names;
}

}  // namespace

std::optional<XmlRpcValue> askMaster(const char* method, const std::vector<XmlRpcValue>& arguments)
{
  XmlRpcValue response;
  XmlRpcValue payload;
  if (!ros::master::execute(method, request(arguments), response, payload, false)) return std::nullopt;
  return payload;
}

std::string ownUri()
{
  return ros::XMLRPCManager::instance()->getServerURI();
}

bool registerPublishers()
{
  std::optional<XmlRpcValue> publications = askSelf("getPublications");  // topics and types
  bool all = publications.has_value();
  for (int i = 0; publications && i < publications->size(); ++i)
    all = askMaster("registerPublisher", {(*publications)[i][0], (*publications)[i][1], ownUri()}) && all;
  return all;
}

bool registerSubscribers()
{
  std::map<std::string, std::set<std::string>> connected = connectedPublishers();
  std::optional<XmlRpcValue> subscriptions = askSelf("getSubscriptions");  // topics and types
  bool all = subscriptions.has_value();
  for (int i = 0; subscriptions && i < subscriptions->size(); ++i)
  {
    const std::string topic = (*subscriptions)[i][0];
    all = registerSubscriber(topic, (*subscriptions)[i][1], connected[topic]) && all;
  }
  return all;
}

bool registerSubscriber(const std::string& topic, const std::string& type)
{
  return registerSubscriber(topic, type, connectedPublishers()[topic]);
}

bool registerServices(ServiceNames names)
{
  names.merge(reconfigureServices());
  const std::uint32_t port = ros::ConnectionManager::instance()->getTCPPort();
  const std::string address = "rosrpc://" + ros::network::getHost() + ":" + std::to_string(port);
  bool all = true;
  for (const std::string& name : names)
    if (ros::ServiceManager::instance()->lookupServicePublication(name))
      all = askMaster("registerService", {name, address, ownUri()}) && all;
  return all;
}

std::optional<ServiceNames> registeredServices()
{
  std::optional<XmlRpcValue> state = askMaster("getSystemState");
  if (!state) return std::nullopt;
  ServiceNames names;
  XmlRpcValue& services = (*state)[2];  // names and the nodes of each
  for (int i = 0; i < services.size(); ++i)
    for (int n = 0; n < services[i][1].size(); ++n)
    {
      const std::string node = services[i][1][n];
      if (node == ros::this_node::getName()) names.insert(services[i][0]);
    }
  return names;
}

void setMissingParams(const std::string& ns, XmlRpcValue params)
{
  if (params.getType() != XmlRpcValue::TypeStruct) return;
  for (const auto& [name, value] : params)
  {
    const std::string key = ns + "/" + name;
    std::optional<XmlRpcValue> has = askMaster("hasParam", {key});
    if (has && !static_cast<bool>(*has)) askMaster("setParam", {key, value});
  }
}

}  // namespace robot_vision
