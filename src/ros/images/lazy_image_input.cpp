#include "lazy_image_input.hpp"

#include <utility>

#include "image_message.hpp"

namespace robot_vision
{

LazyImageInput::LazyImageInput(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name,
                               Process process, std::function<bool()> is_wanted, std::function<void(bool)> on_listen)
  : nh_(nh),
    name_(name),
    process_(std::move(process)),
    on_listen_(std::move(on_listen)),
    diagnostics_(nh, pnh, name),
    it_(nh),
    hints_(readTransport(it_, pnh)),
    subscriber_(nh, pnh, diagnostics_.statistics(), std::move(is_wanted), [this](bool wanted) { listen(wanted); })
{
  if (nh.resolveName("image") == "/image")
    ROS_WARN("%s: topic 'image' is not remapped; typical use is image:=/usb_cam/image_raw", name_.c_str());
}

LazyImageInput::~LazyImageInput()
{
  subscriber_.stop();        // from now on no connection changes subscription_
  subscription_.shutdown();  // waits for the frame in progress, whose results are still published
}

void LazyImageInput::start()
{
  diagnostics_.statistics().setIdle();
  subscriber_.start();
}

void LazyImageInput::listen(bool wanted)
{
  if (wanted)
  {
    diagnostics_.statistics().resumed();
    subscription_ = ImageSubscription(nh_, it_, "image", hints_,
                                      [this](const sensor_msgs::ImageConstPtr& message) { onImage(message); });
    diagnostics_.statistics().setRunning(subscription_.topic());
  }
  else
  {
    subscription_.shutdown();
    diagnostics_.statistics().setIdle();
  }
  on_listen_(wanted);
}

void LazyImageInput::onImage(const sensor_msgs::ImageConstPtr& message)
{
  const auto begin = FrameStatistics::Clock::now();
  diagnostics_.statistics().received(message->header.seq);
  try
  {
    process_(message, viewPixels(*message));
    diagnostics_.statistics().published(begin, message->header.stamp);
  }
  catch (const std::exception& e)
  {
    const std::string what = describeRefusal(*message, subscription_.topic(), e.what());
    diagnostics_.statistics().refused(what);
    if (throttle_.due()) ROS_ERROR("%s: %s", name_.c_str(), what.c_str());
  }
}

}  // namespace robot_vision
