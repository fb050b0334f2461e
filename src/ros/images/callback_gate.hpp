#pragma once

#include <ros/ros.h>

#include <memory>
#include <vector>

namespace robot_vision
{

/// What the callbacks of an object pass on their way to it, until it ends. roscpp waits for a callback under way when a
/// subscription, service or timer is given up, but no more once it is being shut down; dynamic_reconfigure's server
/// lets go what its service uses before the service.
class CallbackGate
{
public:
  CallbackGate();
  ~CallbackGate();
  CallbackGate(const CallbackGate&) = delete;
  CallbackGate& operator=(const CallbackGate&) = delete;

  /// From now on the callbacks of this handle, and of all that are made from it, pass the gate.
  void guard(ros::NodeHandle& nh);
  /// Waits for the callbacks under way and drops those to come. To be called first of all that ends the object, and not
  /// by a callback.
  void close();

private:
  class State;
  class Callback;
  class Queue;
  std::shared_ptr<State> state_;
  std::vector<std::unique_ptr<Queue>> queues_;
};

}  // namespace robot_vision
