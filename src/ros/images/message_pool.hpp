#pragma once

#include <algorithm>
#include <boost/shared_ptr.hpp>
#include <cstddef>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

namespace robot_vision
{

/// A pool of messages with much `data`, which are reused when nobody in the process holds them any more, so that large
/// ones cost no page faults. The memory that is kept is limited; and messages far larger than the one that came back
/// last are freed, so that one huge message does not occupy memory for ever. Thread-safe; copies of a pool share their
/// messages.
template <class Message>
class MessagePool
{
public:
  static constexpr std::size_t kMaxKept = std::size_t{1} << 27;  // bytes, of all messages in the pool

  MessagePool() : store_(std::make_shared<Store>()) {}

  /// Takes a message whose content is undefined.
  boost::shared_ptr<Message> take() const
  {
    return {store_->take().release(),
            [store = store_](Message* message) { store->giveBack(std::unique_ptr<Message>(message)); }};
  }

  /// The bytes of all messages in the pool.
  std::size_t kept() const { return store_->kept(); }

private:
  class Store
  {
  public:
    using Owned = std::unique_ptr<Message>;

    Owned take()
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (idle_.empty()) return std::make_unique<Message>();
      Owned message = std::move(idle_.back());
      idle_.pop_back();
      return message;
    }

    void giveBack(Owned message)
    {
      const std::size_t limit = kMaxSizeRatio * std::max(message->data.size(), kMinLimit);
      const std::lock_guard<std::mutex> lock(mutex_);
      idle_.push_back(std::move(message));
      const auto too_large = [limit](const Owned& other) { return other->data.capacity() > limit; };
      idle_.erase(std::remove_if(idle_.begin(), idle_.end(), too_large), idle_.end());
      if (idle_.size() > kMaxPooled || bytes() > kMaxKept) idle_.pop_back();
    }

    std::size_t kept()
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      return bytes();
    }

  private:
    static constexpr std::size_t kMaxPooled = 4;  // one that is being filled, one queued, two held by slow subscribers
    static constexpr std::size_t kMaxSizeRatio = 4;    // of a kept message to the last one that came back
    static constexpr std::size_t kMinLimit = 1 << 20;  // bytes; those up to this, times the ratio, are always kept

    std::size_t bytes() const
    {
      const auto add = [](std::size_t sum, const Owned& message) { return sum + message->data.capacity(); };
      return std::accumulate(idle_.begin(), idle_.end(), std::size_t{0}, add);
    }

    std::mutex mutex_;
    std::vector<Owned> idle_;
  };

  std::shared_ptr<Store> store_;
};

}  // namespace robot_vision
