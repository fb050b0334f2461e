#include "lazy_image_filter.hpp"

#include <stdexcept>
#include <utility>

#include "ros/params/params.hpp"

namespace robot_vision
{

LazyImageFilter::LazyImageFilter(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name,
                                 Step step)
  : nh_(nh), pnh_(pnh), name_(name), step_(std::move(step)), diagnostics_(nh, pnh, name), it_(nh), private_it_(pnh)
{
  readParam(pnh_, "always_subscribe", always_subscribe_);
  std::string transport = "raw";
  readParam(pnh_, "image_transport", transport);
  requireTransport(it_, transport);  // at start, because later the exception would come with the first subscriber
  if (nh.resolveName("image") == "/image")
    ROS_WARN("%s: topic 'image' is not remapped; typical use is image:=/usb_cam/image_raw", name_.c_str());
  const auto on_connection = [this](const image_transport::SingleSubscriberPublisher&) { updateSubscription(); };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    publisher_ = private_it_.advertise("processed_image", 1, on_connection, on_connection);
  }
  updateSubscription();
}

LazyImageFilter::~LazyImageFilter()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;  // from now on no connection changes subscription_
  }
  subscription_.shutdown();  // waits for the frame in progress, which is still published
  publisher_.shutdown();
}

void LazyImageFilter::updateSubscription()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (stopping_) return;
  const bool wanted = always_subscribe_ || publisher_.getNumSubscribers() > 0;
  if (wanted && !subscription_)
  {
    // Without this option small packets would wait for each other.
    const image_transport::TransportHints hints("raw", ros::TransportHints().tcpNoDelay(), pnh_);
    diagnostics_.statistics().resumed();
    subscription_ = ImageSubscription(nh_, it_, "image", hints,
                                      [this](const sensor_msgs::ImageConstPtr& message) { onImage(message); });
    diagnostics_.statistics().setRunning(subscription_.topic());
  }
  else if (!wanted)
  {
    subscription_.shutdown();
    diagnostics_.statistics().setIdle();
  }
}

void LazyImageFilter::onImage(const sensor_msgs::ImageConstPtr& message)
{
  const auto begin = FrameStatistics::Clock::now();
  diagnostics_.statistics().received(message->header.seq);
  try
  {
    publisher_.publish(sensor_msgs::ImageConstPtr(process(*message)));
    diagnostics_.statistics().published(begin, message->header.stamp);
  }
  catch (const std::exception& e)
  {
    const std::string what = describeRefusal(*message, subscription_.topic(), e.what());
    diagnostics_.statistics().refused(what);
    if (throttle_.due()) ROS_ERROR("%s: %s", name_.c_str(), what.c_str());
  }
}

sensor_msgs::ImagePtr LazyImageFilter::process(const sensor_msgs::Image& message)
{
  const cv::Mat image = viewPixels(message);
  const sensor_msgs::ImagePtr result = pool_.take(image.size(), step_.output_encoding(message.encoding));
  result->header = message.header;
  cv::Mat out = writablePixels(*result);
  step_.apply(image, message.encoding, out);
  if (out.data != result->data.data()) throw std::logic_error("the result does not fit its message");
  return result;
}

}  // namespace robot_vision
