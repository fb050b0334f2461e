#pragma once

#include <ros/ros.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <exception>
#include <mutex>
#include <string>
#include <utility>

#include "ros/images/newest_worker.hpp"
#include "transport_settings.hpp"

namespace robot_vision
{

/// A topic of compressed images with live settings in its namespace. Images are encoded in another thread, the newest
/// next, so that publish() does not wait; images that come too fast are dropped. Their order is kept.
template <class Config, class Params>
class EncodedOutput
{
public:
  using Settings = TransportSettings<Config, Params>;
  using Encode = sensor_msgs::CompressedImage (*)(const sensor_msgs::Image&, const Params&);

  EncodedOutput(ros::NodeHandle& nh, const std::string& topic, typename Settings::ToParams to_params, Encode encode,
                const ros::SubscriberStatusCallback& on_connection)
    : encode_(encode),
      settings_(ros::NodeHandle(topic), to_params),
      publisher_(nh.advertise<sensor_msgs::CompressedImage>(topic, 1, on_connection, on_connection))
  {
  }

  /// True if the topic has subscribers.
  bool wanted() const { return publisher_.getNumSubscribers() > 0; }

  /// Publishes an image that is already compressed, after those that are being encoded.
  void passOn(const sensor_msgs::CompressedImage& message)
  {
    worker_.settle();
    publisher_.publish(message);
  }

  /// Encodes and publishes an image. Throws the exception of an earlier image that could not be encoded.
  void publish(const sensor_msgs::ImageConstPtr& message)
  {
    worker_.post([this, message] { encode(*message); });
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

private:
  void encode(const sensor_msgs::Image& message)
  try
  {
    if (wanted()) publisher_.publish(encode_(message, settings_.params()));
  }
  catch (const std::exception&)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    error_ = std::current_exception();
  }

  Encode encode_;
  Settings settings_;
  ros::Publisher publisher_;
  std::mutex mutex_;  // guards error_
  std::exception_ptr error_;
  NewestWorker worker_;  // must be destroyed first, because its thread uses all the others
};

}  // namespace robot_vision
