#include "topic_publishers.hpp"

#include <ros/ros.h>

#include <algorithm>
#include <vector>

#include "own_registrations.hpp"

namespace robot_vision
{
namespace
{

using XmlRpc::XmlRpcValue;

bool contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool isSubscribedHere(const std::string& topic)
{
  std::vector<std::string> topics;
  ros::this_node::getSubscribedTopics(topics);
  return contains(topics, topic);
}

/// A master that was started again may know another node of this name, which it would shut down for this one.
bool isKnown()
{
  std::optional<XmlRpcValue> known = askMaster("lookupNode", {ros::this_node::getName()});
  return known && static_cast<std::string>(*known) == ownUri();
}

}  // namespace

bool isPublishedHere(const std::string& topic)
{
  std::vector<std::string> topics;
  ros::this_node::getAdvertisedTopics(topics);
  return contains(topics, topic);
}

std::optional<std::set<std::string>> publishersOf(const std::string& topic, const std::string& type)
try
{
  if (!isKnown()) return std::nullopt;
  std::optional<XmlRpcValue> answer = askMaster("registerSubscriber", {topic, type, ownUri()});
  if (!answer) return std::nullopt;
  std::set<std::string> publishers;
  for (int i = 0; i < answer->size(); ++i)
    publishers.insert(static_cast<std::string>((*answer)[i]));
  return publishers;
}
catch (const XmlRpc::XmlRpcException&)  // an answer of an unexpected type
{
  return std::nullopt;
}

void forgetSubscription(const std::string& topic, const std::string& type)
try
{
  if (isSubscribedHere(topic)) return;
  askMaster("unregisterSubscriber", {topic, ownUri()});
  // Another thread may have subscribed meanwhile, whose registration this was then. A publisher that has come since is
  // told in no other answer.
  if (isSubscribedHere(topic)) registerSubscriber(topic, type);
}
catch (const XmlRpc::XmlRpcException&)  // an answer of an unexpected type
{
}

}  // namespace robot_vision
