#pragma once

#include <nodelet/nodelet.h>

#include <exception>

#include "callback_gate.hpp"
#include "robot_vision/common/printable.hpp"

namespace robot_vision
{

/// A nodelet whose callbacks wait until it has begun, though the manager's threads call what comes from the first topic
/// on. The destructor of what is made of it has to call stop().
class GatedNodelet : public nodelet::Nodelet
{
protected:
  /// Begins the work. Throws std::exception to tell why it cannot.
  virtual void begin() = 0;

  /// Ends what has begun, also if not all of it has. May be called twice.
  virtual void stop() = 0;

  CallbackGate gate_;  // of both handles; destroyed after all that roscpp may still call, as it uses its queues

private:
  void onInit() final
  try
  {
    gate_.guard(getNodeHandle());
    gate_.guard(getPrivateNodeHandle());
    gate_.between()([this] { begin(); });
  }
  catch (const std::exception& e)
  {
    NODELET_FATAL("%s: %s", getName().c_str(), logLine(e.what()).c_str());
    stop();  // here, because the loader destroys the callback queues before the nodelet
    throw;   // so that the loader reports a failure instead of keeping a dead nodelet
  }
};

}  // namespace robot_vision
