#pragma once

#include <memory>
#include <string>

namespace robot_vision
{

/// Registers this process again with a restarted master, which has forgotten everything. It registers all topics and
/// services of the process, because for the master a nodelet manager is one node, whatever package its nodelets are
/// from; a service that comes without a topic, from the check after the next topic or after noteServices() on. Existing
/// connections stay. Parameters of the namespace `ns` that the new master does not have are set to their last values.
class Registration
{
public:
  /// `node` and `node_uri` are the name and the URI of another client library's node in this process, if there is one.
  /// While the master knows another node by one of the names of this process, nothing is registered, because the master
  /// would shut that node down.
  explicit Registration(const std::string& ns, const std::string& node = "", const std::string& node_uri = "");
  /// Must be destroyed before the process unregisters itself.
  ~Registration();
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  /// Has the master checked soon. To be called after services were advertised, because the last check before the master
  /// ends determines what is registered again.
  void noteServices();

private:
  class Watch;
  std::shared_ptr<Watch> watch_;  // one for the whole process
  std::string ns_;
};

}  // namespace robot_vision
