#pragma once

#include <functional>
#include <memory>
#include <thread>

namespace robot_vision
{

/// Has the subscriptions of this process look, in a thread of its own, whether they should change how they get their
/// images: a few times a second, and when one asks for it. They may wait for the master in there.
class SubscriptionWatch
{
public:
  class Watched
  {
  public:
    virtual ~Watched() = default;
    virtual void review() = 0;
  };

  /// While one exists, its thread does not wait for the end of a watch, as a review may wait for that thread.
  class Callback
  {
  public:
    Callback() { ++depth_; }
    ~Callback() { --depth_; }
    Callback(const Callback&) = delete;
    Callback& operator=(const Callback&) = delete;

  private:
    friend class SubscriptionWatch;
    static thread_local int depth_;
  };

  SubscriptionWatch();
  ~SubscriptionWatch();
  SubscriptionWatch(const SubscriptionWatch&) = delete;
  SubscriptionWatch& operator=(const SubscriptionWatch&) = delete;

  void add(const std::shared_ptr<Watched>& subscription);
  /// A function that has all of them look now. It may be called by any thread, also when the watch has ended.
  std::function<void()> waker() const;

private:
  class Work;

  std::shared_ptr<Work> work_;  // may outlive this
  std::thread thread_;
};

}  // namespace robot_vision
