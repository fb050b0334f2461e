#include "params.hpp"

#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpc.h>

#include <map>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "robot_vision/common/printable.hpp"
#include "unknown_params.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxValueLength = 100;  // bytes, of a value in a message

std::string shown(const std::string& value)
{
  return "'" + shortened(value, kMaxValueLength) + "'";
}

template <class T>
std::string shown(const T& value)
{
  std::ostringstream text;
  text << std::boolalpha << value;
  return text.str();
}

/// What the parameter server has of a node, which is one question, while each parameter would be one of its own.
class PresentParams
{
public:
  explicit PresentParams(const ros::NodeHandle& nh) : nh_(nh)
  {
    XmlRpc::XmlRpcValue found;
    if (nh.getParam(nh.getNamespace(), found) && found.getType() == XmlRpc::XmlRpcValue::TypeStruct) all_ = found;
  }

  /// Finds a parameter. If there are none, it may be that roscpp does not understand one of them.
  bool find(const std::string& name, XmlRpc::XmlRpcValue& found)
  {
    if (!isOwn(name) || !all_.valid()) return nh_.getParam(name, found);
    if (!all_.hasMember(name)) return false;
    found = all_[name];
    return true;
  }

  bool has(const std::string& name, const XmlRpc::XmlRpcValue& value)
  {
    return isOwn(name) && all_.valid() && all_.hasMember(name) && all_[name] == value;
  }

private:
  /// A parameter may be remapped to one of somebody else.
  bool isOwn(const std::string& name) const { return nh_.resolveName(name) == nh_.getNamespace() + "/" + name; }

  const ros::NodeHandle& nh_;
  XmlRpc::XmlRpcValue all_;
};

bool convert(XmlRpc::XmlRpcValue& found, bool& value)
{
  if (found.getType() != XmlRpc::XmlRpcValue::TypeBoolean) return false;
  value = static_cast<bool&>(found);
  return true;
}

bool convert(XmlRpc::XmlRpcValue& found, int& value)
{
  if (found.getType() != XmlRpc::XmlRpcValue::TypeInt) return false;
  value = static_cast<int&>(found);
  return true;
}

bool convert(XmlRpc::XmlRpcValue& found, double& value)
{
  int whole = 0;
  if (convert(found, whole))
    value = whole;
  else if (found.getType() == XmlRpc::XmlRpcValue::TypeDouble)
    value = static_cast<double&>(found);
  else
    return false;
  return true;
}

bool convert(XmlRpc::XmlRpcValue& found, std::string& value)
{
  if (found.getType() != XmlRpc::XmlRpcValue::TypeString) return false;
  value = static_cast<std::string&>(found);
  return true;
}

/// Puts what was found into `value`; throws std::invalid_argument if it has another type.
template <class T>
void take(const ros::NodeHandle& nh, const std::string& name, XmlRpc::XmlRpcValue& found, T& value)
{
  constexpr const char* kType = std::is_same_v<T, bool>     ? "true or false"
                                : std::is_same_v<T, int>    ? "an integer"
                                : std::is_same_v<T, double> ? "a number"
                                                            : "a string";
  const T default_value = value;
  if (!convert(found, value)) throw std::invalid_argument(name + " is " + valueText(found) + ", must be " + kType);
  if (value != default_value) noteKnownParam(nh, name, shown(value));
}

/// Sets parameters with one question to the master, a list of calls, as roslaunch does. False if it takes no lists.
bool setAtOnce(const ros::NodeHandle& nh, const std::map<std::string, XmlRpc::XmlRpcValue>& values)
{
  XmlRpc::XmlRpcValue calls, answers;
  int number = 0;
  for (const auto& [name, value] : values)
  {
    XmlRpc::XmlRpcValue& call = calls[0][number++];
    call["methodName"] = "setParam";
    // The master tells the one who sets a parameter no news of it. In the name of the nodelet it tells its manager,
    // where others may keep the value; ros::param::set() would tell them itself.
    call["params"][0] = nh.getNamespace();
    call["params"][1] = nh.resolveName(name);
    call["params"][2] = value;
  }
  const ros::XMLRPCManagerPtr& manager = ros::XMLRPCManager::instance();
  XmlRpc::XmlRpcClient* const master =
      manager->getXMLRPCClient(ros::master::getHost(), static_cast<int>(ros::master::getPort()), "/");
  const bool answered = master->execute("system.multicall", calls, answers) && !master->isFault();
  manager->releaseXMLRPCClient(master);
  if (!answered || answers.getType() != XmlRpc::XmlRpcValue::TypeArray || answers.size() != number) return false;
  for (int i = 0; i < number; ++i)  // a struct tells of an error
    if (answers[i].getType() != XmlRpc::XmlRpcValue::TypeArray) return false;
  return true;
}

/// Calls visit(name, value) for each parameter, with a bool for the integer that the message has of one.
template <class Visit>
void forEachParam(dynamic_reconfigure::Config& config, const Visit& visit)
{
  for (auto& p : config.bools)
  {
    bool value = p.value != 0;
    visit(p.name, value);
    p.value = value;
  }
  for (auto& p : config.ints)
    visit(p.name, p.value);
  for (auto& p : config.doubles)
    visit(p.name, p.value);
  for (auto& p : config.strs)
    visit(p.name, p.value);
}

}  // namespace

std::string valueText(const XmlRpc::XmlRpcValue& value)
{
  std::ostringstream stream;
  stream << value;
  if (value.getType() == XmlRpc::XmlRpcValue::TypeString) return shown(stream.str());
  return shortened(stream.str(), kMaxValueLength);
}

template <class T>
void readParam(const ros::NodeHandle& nh, const std::string& name, T& value)
{
  noteKnownParam(nh, name);
  XmlRpc::XmlRpcValue found;
  if (nh.getParam(name, found)) take(nh, name, found, value);
}

template void readParam(const ros::NodeHandle& nh, const std::string& name, bool& value);
template void readParam(const ros::NodeHandle& nh, const std::string& name, int& value);
template void readParam(const ros::NodeHandle& nh, const std::string& name, double& value);
template void readParam(const ros::NodeHandle& nh, const std::string& name, std::string& value);

void readParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config& config)
{
  PresentParams present(nh);
  forEachParam(config,
               [&](const std::string& name, auto& value)
               {
                 noteKnownParam(nh, name);
                 XmlRpc::XmlRpcValue found;
                 if (present.find(name, found)) take(nh, name, found, value);
               });
}

void readFittingParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config& config)
{
  PresentParams present(nh);
  forEachParam(config,
               [&](const std::string& name, auto& value)
               {
                 XmlRpc::XmlRpcValue found;
                 if (present.find(name, found) && !convert(found, value)) nh.getParam(name, value);
               });
}

void writeParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config config)
{
  PresentParams present(nh);
  std::map<std::string, XmlRpc::XmlRpcValue> missing;
  forEachParam(config,
               [&](const std::string& name, const auto& value)
               {
                 if (const XmlRpc::XmlRpcValue wanted(value); !present.has(name, wanted)) missing[name] = wanted;
               });
  if (missing.empty() || setAtOnce(nh, missing)) return;
  for (const auto& [name, value] : missing)
    nh.setParam(name, value);
}

}  // namespace robot_vision
