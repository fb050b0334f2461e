#pragma once

#include <ros/ros.h>

#include <functional>
#include <memory>
#include <vector>

namespace robot_vision
{

/// Protects an object from callbacks during its destruction. roscpp waits for a running callback when a subscription is
/// shut down, but since 1.15.10 (https://github.com/ros/ros_comm/pull/2121) not when a timer, a service or a publisher
/// is, whose connections have callbacks, and for none once roscpp itself is being shut down; and dynamic_reconfigure's
/// server destroys what its service uses before the service. What passes a gate is not called once it was removed.
class CallbackGate
{
public:
  using Work = std::function<void()>;
  using Between = std::function<void(const Work&)>;

  CallbackGate();
  ~CallbackGate();
  CallbackGate(const CallbackGate&) = delete;
  CallbackGate& operator=(const CallbackGate&) = delete;

  /// From now on the callbacks of this handle, and of all handles made from it, pass the gate.
  void guard(ros::NodeHandle& nh);
  /// Waits for the running callbacks and drops those to come. To be called before anything else is destroyed, but not
  /// by a callback.
  void close();

  /// A function that does work while none of the callbacks runs. If that ends a topic, a service or a timer, its
  /// callbacks have ended and are called no more. It may outlive the gate. No callback may call it.
  Between between() const;

private:
  class State;
  class Callback;
  class Queue;
  std::shared_ptr<State> state_;
  std::vector<std::unique_ptr<Queue>> queues_;
};

}  // namespace robot_vision
