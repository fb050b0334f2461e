#pragma once

#include <optional>
#include <set>
#include <string>

namespace robot_vision
{

/// Whether this process publishes a topic (absolute).
bool isPublishedHere(const std::string& topic);

/// The URIs of the nodes that publish a topic, as the master says; empty if it does not answer, or does not know this
/// process. There is only one question that the master answers for less than the state of the whole graph: it registers
/// this node as a subscriber. So it may only be asked for topics that this node reads in one way or another.
std::optional<std::set<std::string>> publishersOf(const std::string& topic, const std::string& type);

/// Ends the registration that publishersOf() has made, unless roscpp subscribes to the topic.
void forgetSubscription(const std::string& topic, const std::string& type);

}  // namespace robot_vision
