#pragma once

#include <bond/Constants.h>
#include <bond/Status.h>
#include <ros/ros.h>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <queue>
#include <string>
#include <thread>
#include <vector>

#include "robot_vision/common/throttle.hpp"
#include "ros/images/callback_gate.hpp"
#include "ros/images/waker.hpp"

namespace robot_vision
{

/// In s.
struct BondTimes
{
  double connect = bond::Constants::DEFAULT_CONNECT_TIMEOUT;      // from form() until the first sign of the other side
  double heartbeat = bond::Constants::DEFAULT_HEARTBEAT_TIMEOUT;  // from one sign of the other side until the next
  double disconnect = bond::Constants::DEFAULT_DISCONNECT_TIMEOUT;  // from end() until the other side has answered
  double period = bond::Constants::DEFAULT_HEARTBEAT_PERIOD;        // from one sign to the next
};

/// The bonds of a nodelet manager with those who have loaded its nodes, in the protocol of http://wiki.ros.org/bond:
/// on one topic each side gives signs of life, and takes the other for dead that gives none for some seconds. All
/// bonds share a publisher, a subscriber and a thread, which waits for roscpp alone: however many there are, and
/// however busy other client libraries of the process are, the signs are in time. Thread-safe.
class Bonds
{
public:
  /// `topic`: the absolute name. While the parameter /bond_disable_heartbeat_timeout is true, for debuggers, no sign is
  /// missed but the first one. Throws std::runtime_error if roscpp is shutting down.
  explicit Bonds(const std::string& topic, const BondTimes& times = {});
  ~Bonds();
  Bonds(const Bonds&) = delete;
  Bonds& operator=(const Bonds&) = delete;

  /// Begins a bond. The other side knows the same `id`. Does nothing if there is one of that id that has not ended, or
  /// after close().
  void form(const std::string& id);
  /// Ends a bond, if there is one of that id, and tells the other side until it answers, for at most a time.
  void end(const std::string& id);
  /// Waits until the other side of a bond has ended or died, whose id it returns; "" after close(), or when roscpp
  /// shuts down. For one thread.
  std::string nextBroken();
  /// Ends all bonds, and waits a moment for the answers. Only the first call does so.
  void close();

private:
  using Clock = Waker::Clock;

  struct Bond
  {
    Clock::time_point sign;   // when the next one of ours is due
    Clock::time_point limit;  // until which the next one of the other side, or its answer, must have come
    std::string other;        // the instance of the other side, once it was heard
    bool ended = false;       // by this side
  };

  struct Wake
  {
    std::shared_ptr<Waker> waker;
    void operator()() const { waker->wake(); }
  };

  void work();
  void take(const bond::Status& status);
  Clock::time_point giveSigns();
  bool isMissed(const std::string& id, Bond& bond, Clock::time_point now);
  void note(const std::string& id, bool active);
  void noteBroken(const std::string& id);
  void publishNoted();
  void endAt(Bond& bond, Clock::time_point now) const;

  const BondTimes times_;
  const std::string instance_;  // distinguishes our messages from those of the other sides
  std::shared_ptr<Waker> waker_ = std::make_shared<Waker>();
  WakingQueue<Wake> queue_{Wake{waker_}};
  CallbackGate gate_;  // to queue_
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  std::thread worker_;
  Throttle kept_;

  std::mutex mutex_;  // guards all below; it is never held while roscpp may wait for the master
  std::condition_variable changed_;
  bool closing_ = false;
  bool closed_ = false;
  std::map<std::string, Bond> bonds_;  // by their ids
  std::vector<bond::Status> noted_;    // to be published by the worker
  std::queue<std::string> broken_;
};

}  // namespace robot_vision
