#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

/// Waits for a condition; returns false if it is still false after a minute.
inline bool waitFor(const std::function<bool()>& condition)
{
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return condition();
}

/// Receives the messages of a topic, given absolutely or in the private namespace. It keeps the last one,
/// and the times of all.
template <class Message>
class Receiver
{
public:
  using Pointer = boost::shared_ptr<const Message>;

  explicit Receiver(const std::string& topic)
    : subscriber_(ros::NodeHandle("~").subscribe<Message>(topic, 100, [this](const Pointer& message) { put(message); }))
  {
  }

  Pointer wait()
  {
    EXPECT_TRUE(waitFor([this] { return last() != nullptr; })) << "on " << subscriber_.getTopic();
    return last();
  }

  Pointer last() const
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_;
  }

  /// The seconds of the stamps of all messages.
  std::vector<std::uint32_t> seconds() const
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return seconds_;
  }

private:
  void put(const Pointer& message)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_ = message;
    seconds_.push_back(message->header.stamp.sec);
  }

  mutable std::mutex mutex_;  // guards last_ and seconds_, which the spinner's threads write
  Pointer last_;
  std::vector<std::uint32_t> seconds_;
  ros::Subscriber subscriber_;
};
