#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

/// Waits for a condition; returns false if it is still false after half a minute.
inline bool waitFor(const std::function<bool()>& condition)
{
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return condition();
}

/// Receives the messages of a topic, given absolutely or in the private namespace, and keeps the last one.
template <class Message>
class Receiver
{
public:
  using Pointer = boost::shared_ptr<const Message>;

  explicit Receiver(const std::string& topic)
    : subscriber_(ros::NodeHandle("~").subscribe<Message>(topic, 10, [this](const Pointer& message) { put(message); }))
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

private:
  void put(const Pointer& message)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_ = message;
  }

  mutable std::mutex mutex_;  // guards last_, which the spinner's threads write
  Pointer last_;
  ros::Subscriber subscriber_;
};
