#pragma once

#include <xmlrpcpp/XmlRpc.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace robot_vision
{

using ServiceNames = std::set<std::string>;

// What the master knows, or shall know, of the roscpp node of this process (Master API in the ROS wiki).

/// Calls a method of the master; empty if it does not answer or answers with an error. The first argument of each
/// method, the name of the caller, is added.
std::optional<XmlRpc::XmlRpcValue> askMaster(const char* method,
                                             const std::vector<XmlRpc::XmlRpcValue>& arguments = {});

/// The URI of this process's own XML-RPC interface.
std::string ownUri();

/// Register all publishers and all subscribers of this process. They return false if a call of the master failed, as
/// the next two functions do.
bool registerPublishers();
bool registerSubscribers();

/// The same for one topic to which roscpp subscribes.
bool registerSubscriber(const std::string& topic, const std::string& type);

/// Registers those of these services that exist, and all of dynamic_reconfigure. roscpp cannot list its services, only
/// tell whether one exists, so the names have to come from registeredServices().
bool registerServices(ServiceNames names);

/// The services of this process that the master knows; empty if the master does not answer.
std::optional<ServiceNames> registeredServices();

/// Sets those members of `params` that the master does not have.
void setMissingParams(const std::string& ns, XmlRpc::XmlRpcValue params);

}  // namespace robot_vision
