#pragma once

#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <boost/make_shared.hpp>

#include "receiver.hpp"

/// Publishes frames on `image`, black and of 64x48 px, at 10 Hz of their own time.
class SmallCamera
{
public:
  static constexpr std::uint32_t kWidth = 64;
  static constexpr std::uint32_t kHeight = 48;

  void show()
  {
    const auto message = boost::make_shared<sensor_msgs::Image>();
    message->header.stamp = ros::Time(100.0 + 0.1 * ++frames_);
    message->encoding = "mono8";
    message->width = message->step = kWidth;
    message->height = kHeight;
    message->data.resize(std::size_t{kWidth} * kHeight);
    publisher_.publish(message);
  }

  /// Shows frames until there is an answer.
  template <class Answers>
  bool showUntil(const Answers& answered)
  {
    return waitFor(
        [&]
        {
          if (publisher_.getNumSubscribers() > 0) show();
          return answered();
        });
  }

private:
  ros::Publisher publisher_ = ros::NodeHandle().advertise<sensor_msgs::Image>("image", 1);
  int frames_ = 0;
};
