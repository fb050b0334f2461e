#include "params.hpp"

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

  /// False if it does not have a parameter. If it has none, it may be that roscpp does not understand one of them.
  bool mayHave(const std::string& name) const { return !isOwn(name) || !all_.valid() || all_.hasMember(name); }

  bool has(const std::string& name, const XmlRpc::XmlRpcValue& value) const
  {
    if (!isOwn(name) || !all_.valid() || !all_.hasMember(name)) return false;
    XmlRpc::XmlRpcValue all = all_;
    return all[name] == value;
  }

private:
  /// A parameter may be remapped to one of somebody else.
  bool isOwn(const std::string& name) const { return nh_.resolveName(name) == nh_.getNamespace() + "/" + name; }

  const ros::NodeHandle& nh_;
  XmlRpc::XmlRpcValue all_;
};

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
  constexpr const char* kType = std::is_same_v<T, bool>     ? "true or false"
                                : std::is_same_v<T, int>    ? "an integer"
                                : std::is_same_v<T, double> ? "a number"
                                                            : "a string";
  const T default_value = value;
  noteKnownParam(nh, name);
  XmlRpc::XmlRpcValue found;
  if (!nh.getParam(name, found)) return;
  const bool rounded = std::is_same_v<T, int> && found.getType() == XmlRpc::XmlRpcValue::TypeDouble;
  if (rounded || !nh.getParam(name, value))
    throw std::invalid_argument(name + " is " + valueText(found) + ", must be " + kType);
  if (value != default_value) noteKnownParam(nh, name, shown(value));
}

template void readParam(const ros::NodeHandle& nh, const std::string& name, bool& value);
template void readParam(const ros::NodeHandle& nh, const std::string& name, int& value);
template void readParam(const ros::NodeHandle& nh, const std::string& name, double& value);
template void readParam(const ros::NodeHandle& nh, const std::string& name, std::string& value);

void readParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config& config)
{
  const PresentParams present(nh);
  forEachParam(config,
               [&](const std::string& name, auto& value)
               {
                 if (present.mayHave(name))
                   readParam(nh, name, value);
                 else
                   noteKnownParam(nh, name);
               });
}

void writeParams(const ros::NodeHandle& nh, dynamic_reconfigure::Config config)
{
  const PresentParams present(nh);
  forEachParam(config,
               [&](const std::string& name, const auto& value)
               {
                 if (!present.has(name, XmlRpc::XmlRpcValue(value))) nh.setParam(name, value);
               });
}

}  // namespace robot_vision
