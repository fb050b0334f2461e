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
  for (auto& p : config.bools)
  {
    bool value = p.value != 0;  // the message's field is an integer
    readParam(nh, p.name, value);
    p.value = value;
  }
  for (auto& p : config.ints)
    readParam(nh, p.name, p.value);
  for (auto& p : config.doubles)
    readParam(nh, p.name, p.value);
  for (auto& p : config.strs)
    readParam(nh, p.name, p.value);
}

}  // namespace robot_vision
