#pragma once

#include <memory>
#include <string>

namespace robot_vision
{

/// Keeps this process known to a master that is started anew, and so knows of nothing: registers its topics and
/// services again, all of them, for a nodelet manager is one node to the master, whosever its nodelets are. Connections
/// that there are stay. Parameters of the namespace `ns` that the new master does not have are set as they were last.
class Registration
{
public:
  /// `node`, at `node_uri`: of another client library in this process. While the master knows another node by its name,
  /// or by that of roscpp's, which it would shut down, nothing is registered.
  explicit Registration(const std::string& ns, const std::string& node = "", const std::string& node_uri = "");
  /// To be called before the process unregisters itself.
  ~Registration();
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  /// To be called when services have been advertised since: the last look before the master goes is what is known.
  void look();

private:
  class Watch;
  std::shared_ptr<Watch> watch_;  // one for all of the process
  std::string ns_;
};

}  // namespace robot_vision
