#pragma once

#include <nodelet/nodelet.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace robot_vision
{

/// The nodelets of a process that is no nodelet manager otherwise. Like nodelet::Loader, but it tells why a nodelet
/// cannot be loaded, and advertises no services. Thread-safe.
class NodeletHost
{
public:
  /// `workers`: the threads for the callbacks; 0 for one for each core.
  explicit NodeletHost(std::uint32_t workers);
  ~NodeletHost();
  NodeletHost(const NodeletHost&) = delete;
  NodeletHost& operator=(const NodeletHost&) = delete;

  /// Loads a nodelet of the type `package/name`. Its name and the remappings are absolute names. Throws
  /// std::runtime_error with the reason if there is no such type, if one of that name is loaded, or if it does not
  /// start.
  void load(const std::string& name, const std::string& type, const nodelet::M_string& remappings,
            const nodelet::V_string& arguments);
  /// Waits for the nodelet's callbacks. Returns false if there is none of that name.
  bool unload(const std::string& name);
  std::vector<std::string> names() const;  // of those that are loaded, in order
  /// The types that can be loaded, of all packages.
  std::vector<std::string> types();
  /// Unloads all; nothing can be loaded any more.
  void close();

private:
  class Types;
  class Workers;
  class Loaded;

  std::unique_ptr<Types> types_;
  std::unique_ptr<Workers> workers_;
  std::mutex starting_;  // held while a nodelet starts or is unloaded: they expect to do so one by one

  mutable std::mutex mutex_;  // guards all below; it is never held while a nodelet starts or ends
  bool closed_ = false;
  std::map<std::string, std::shared_ptr<Loaded>> loaded_;  // by name
};

}  // namespace robot_vision
