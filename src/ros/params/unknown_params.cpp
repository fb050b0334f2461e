#include "unknown_params.hpp"

#include <image_transport/image_transport.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <vector>

#include "robot_vision/common/printable.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinSimilarity = 0.6;       // of a misspelt name
constexpr std::size_t kMaxPathLength = 300;  // bytes, of a path in a message

using Names = std::map<std::string, std::string>;  // name -> value as text, empty if it is the default

/// The parameters of the nodes that are starting in this process, by namespace.
struct KnownParams
{
  std::mutex mutex;  // guards names, because nodelets start in several threads
  std::map<std::string, Names> names;
};

KnownParams& knownParams()
{
  static KnownParams known;
  return known;
}

/// Takes the parameters of a namespace out of the collection, because another nodelet may be loaded into it later.
Names takeKnownParams(const std::string& ns)
{
  const std::lock_guard<std::mutex> lock(knownParams().mutex);
  const auto taken = knownParams().names.extract(ns);
  return taken ? taken.mapped() : Names();
}

/// The similarity of two words, 0 to 1: twice the length of their longest common subsequence over their total length.
double similarity(const std::string& a, const std::string& b)
{
  std::vector<std::size_t> common(b.size() + 1, 0);  // lengths for the letters of a so far and each beginning of b
  for (const char letter : a)
  {
    std::size_t before = 0;
    for (std::size_t i = 0; i < b.size(); ++i)
    {
      const std::size_t both = letter == b[i] ? before + 1 : std::max(common[i], common[i + 1]);
      before = common[i + 1];
      common[i + 1] = both;
    }
  }
  return 2.0 * static_cast<double>(common.back()) / static_cast<double>(a.size() + b.size());
}

/// The most similar known name; empty if none is similar.
std::string nearest(const std::string& name, const Names& known)
{
  std::string best;
  double best_similarity = kMinSimilarity;
  for (const auto& [other, changed] : known)
    if (similarity(name, other) > best_similarity)
    {
      best = other;
      best_similarity = similarity(name, other);
    }
  return best;
}

/// True if there is a node, topic or service of this name or below it.
bool isNamespaceOfGraph(const std::string& name)
{
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return false;
  const auto below = [&name](XmlRpc::XmlRpcValue& other)
  { return (static_cast<std::string&>(other) + "/").compare(0, name.size() + 1, name + "/") == 0; };
  for (int kind = 0; kind < state.size(); ++kind)  // publishers, subscribers, services
    for (int i = 0; i < state[kind].size(); ++i)
    {
      if (below(state[kind][i][0])) return true;
      for (int j = 0; j < state[kind][i][1].size(); ++j)
        if (below(state[kind][i][1][j])) return true;
    }
  return false;
}

/// The full name of a parameter. resolveName() would throw for characters that only parameters can have, such as
/// blanks.
std::string pathOf(const ros::NodeHandle& nh, const std::string& name)
{
  return nh.getNamespace() + "/" + name;
}

/// True if a map of parameters may belong to a transport, or to a node or topic below this one.
bool belongsToOthers(const ros::NodeHandle& nh, const std::string& name)
{
  const auto transports = image_transport::ImageTransport(nh).getDeclaredTransports();
  return std::count(transports.begin(), transports.end(), "image_transport/" + name) != 0 ||
         isNamespaceOfGraph(pathOf(nh, name));
}

void logChanged(const ros::NodeHandle& nh, const Names& known)
{
  std::string text;
  for (const auto& [name, changed] : known)
    if (!changed.empty()) text += (text.empty() ? "" : ", ") + name + ": " + changed;
  if (!text.empty()) ROS_INFO("%s: set on the parameter server: %s", nh.getNamespace().c_str(), text.c_str());
}

}  // namespace

void noteKnownParam(const ros::NodeHandle& nh, const std::string& name, const std::string& changed)
{
  const std::lock_guard<std::mutex> lock(knownParams().mutex);
  knownParams().names[nh.getNamespace()][name] = changed;
}

void reviewParams(const ros::NodeHandle& nh)
{
  Names known = takeKnownParams(nh.getNamespace());
  std::string config_file;  // it is read only when values are saved
  nh.getParam("config_file", config_file);
  known["config_file"] = config_file.empty() ? "" : "'" + shortened(config_file, kMaxPathLength) + "'";
  logChanged(nh, known);
  XmlRpc::XmlRpcValue there;
  if (!nh.getParam(nh.getNamespace(), there) || there.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  for (const auto& entry : there)
  {
    const std::string& name = entry.first;
    if (known.count(name)) continue;
    if (entry.second.getType() == XmlRpc::XmlRpcValue::TypeStruct && belongsToOthers(nh, name)) continue;
    const std::string near = nearest(name, known);
    ROS_WARN("parameter %s is not known%s", shortened(pathOf(nh, name), kMaxPathLength).c_str(),
             near.empty() ? "" : (", is " + near + " meant?").c_str());
  }
}

}  // namespace robot_vision
