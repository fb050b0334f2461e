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

#include "ros/images/callback_gate.hpp"
#include "ros/images/waker.hpp"

namespace robot_vision
{

/// In s.
struct BondTimes
{
  double connect = bond::Constants::DEFAULT_CONNECT_TIMEOUT;      // from form() until the first sign of the other side
  double heartbeat = bond::Constants::DEFAULT_HEARTBEAT_TIMEOUT;  // from one sign of the other side until the next
  double period = bond::Constants::DEFAULT_HEARTBEAT_PERIOD;      // from one sign to the next
};

/// The bonds of a nodelet manager with those who have loaded its nodes, in the protocol of http://wiki.ros.org/bond:
/// on one topic each side gives signs of life, and takes the other for dead that gives none for some seconds. All
/// bonds share a publisher, a subscriber and a thread, which needs nothing of other client libraries: however many
/// there are, and however busy those are, the signs are in time. Thread-safe.
class Bonds
{
public:
  /// `topic`: the absolute name. As with other bonds, no sign is missed if the parameter
  /// /bond_disable_heartbeat_timeout is true, for debuggers.
  explicit Bonds(const std::string& topic, const BondTimes& times = {});
  ~Bonds() { close(); }
  Bonds(const Bonds&) = delete;
  Bonds& operator=(const Bonds&) = delete;

  /// Begins a bond. The other side knows the same `id`, which no other bond has.
  void form(const std::string& id);
  /// Ends a bond, if there is one of that id, and tells the other side until it has answered.
  void end(const std::string& id);
  /// Waits until the other side of a bond has ended or died, whose id it returns; "" after close(). For one thread.
  std::string nextBroken();
  /// Ends all bonds. Waits a moment for the answers.
  void close();

private:
  using Clock = Waker::Clock;

  struct Bond
  {
    std::string instance;     // distinguishes our messages from those of the other side
    bool ended = false;       // by this side
    Clock::time_point sign;   // when the next one of ours is due
    Clock::time_point limit;  // until which one of the other must have come
  };

  struct Wake
  {
    std::shared_ptr<Waker> waker;
    void operator()() const { waker->wake(); }
  };

  void work();
  void take(const bond::Status& status);
  Clock::time_point giveSigns();
  /// Whether a sign of the other side is missed, or an answer.
  bool counts(const Bond& one) const { return one.ended || !patient_; }
  void publish(const std::string& id, const Bond& one, bool active);
  void endAt(Bond& one, Clock::time_point now);
  void noteBroken(const std::string& id);

  const BondTimes times_;
  bool patient_ = false;  // misses no sign
  std::shared_ptr<Waker> waker_ = std::make_shared<Waker>();
  WakingQueue<Wake> queue_{Wake{waker_}};
  CallbackGate gate_;  // to queue_
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;

  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  bool closed_ = false;
  std::map<std::string, Bond> bonds_;  // by their ids
  std::queue<std::string> broken_;
  std::thread worker_;
};

}  // namespace robot_vision
