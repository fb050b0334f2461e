#include "unknown_params.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <vector>

namespace robot_vision
{
namespace
{

constexpr double kAlike = 0.6;

using Names = std::set<std::string>;

/// The parameters of the nodes of this process that are starting, by namespace.
class KnownParams
{
public:
  void add(const std::string& ns, const std::string& name)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    names_[ns].insert(name);
  }

  /// Those of a namespace, which are forgotten: another nodelet may be loaded into it.
  Names take(const std::string& ns)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    Names names;
    names.swap(names_[ns]);
    names_.erase(ns);
    return names;
  }

private:
  std::mutex mutex_;  // guards names_: nodelets start in several threads
  std::map<std::string, Names> names_;
};

KnownParams& knownParams()
{
  static KnownParams known;
  return known;
}

/// 0 to 1: twice the letters that two words have in common, in the same order, of all their letters.
double similarity(const std::string& a, const std::string& b)
{
  std::vector<std::size_t> common(b.size() + 1, 0);  // of what has been seen of a, and the beginnings of b
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

/// The one that is most alike; empty if none is.
std::string nearest(const std::string& name, const Names& known)
{
  std::string best;
  double most = kAlike;
  for (const std::string& other : known)
    if (similarity(name, other) > most)
    {
      best = other;
      most = similarity(name, other);
    }
  return best;
}

}  // namespace

void noteKnownParam(const ros::NodeHandle& nh, const std::string& name)
{
  knownParams().add(nh.getNamespace(), name);
}

void warnOfUnknownParams(const ros::NodeHandle& nh)
{
  Names known = knownParams().take(nh.getNamespace());
  known.insert("config_file");  // it is read when something is saved
  XmlRpc::XmlRpcValue there;
  if (!nh.getParam(nh.getNamespace(), there) || there.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  for (const auto& entry : there)
  {
    const std::string& name = entry.first;
    if (known.count(name) || entry.second.getType() == XmlRpc::XmlRpcValue::TypeStruct) continue;
    const std::string near = nearest(name, known);
    ROS_WARN("parameter %s is not known%s", nh.resolveName(name).c_str(),
             near.empty() ? "" : (", is " + near + " meant?").c_str());
  }
}

}  // namespace robot_vision
