#include "lazy_image_input.hpp"

#include <exception>
#include <utility>

#include "image_message.hpp"
#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr double kUpdatePeriod = 1.0;  // s

}  // namespace

LazyImageInput::LazyImageInput(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name,
                               Process process, std::function<bool()> is_wanted, std::function<void(bool)> on_listen)
  : nh_(nh),
    pnh_(pnh),
    name_(name),
    process_(std::move(process)),
    is_wanted_(std::move(is_wanted)),
    on_listen_(std::move(on_listen)),
    diagnostics_(nh, pnh, name),
    it_(nh)
{
  readParam(pnh_, "always_subscribe", always_subscribe_);
  std::string transport = "raw";
  readParam(pnh_, "image_transport", transport);
  requireTransport(it_, transport);  // at start, because later the exception would come with the first subscriber
  if (nh.resolveName("image") == "/image")
    ROS_WARN("%s: topic 'image' is not remapped; typical use is image:=/usb_cam/image_raw", name_.c_str());
}

LazyImageInput::~LazyImageInput()
{
  timer_.stop();
  {
    std::unique_lock<std::mutex> lock(mutex_);
    running_ = false;  // from now on no connection changes subscription_
    updated_.wait(lock, [this] { return !updating_; });
  }
  subscription_.shutdown();  // waits for the frame in progress, whose results are still published
}

void LazyImageInput::start()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    running_ = true;
    diagnostics_.statistics().setIdle();
  }
  update();
  // The loader of nodelets drops callbacks until onInit() returns, also those of subscribers that come meanwhile; and a
  // topic that is withdrawn does not tell that its subscribers are gone.
  timer_ = nh_.createWallTimer(ros::WallDuration(kUpdatePeriod), [this](const ros::WallTimerEvent&) { update(); });
}

void LazyImageInput::update()
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_ = true;
  if (updating_) return;
  updating_ = true;
  std::exception_ptr error;
  while (running_ && !error && std::exchange(changed_, false))
  {
    lock.unlock();  // because the master is asked, and callbacks must not wait for that
    try
    {
      subscribeIfWanted();
    }
    catch (...)
    {
      error = std::current_exception();
    }
    lock.lock();
  }
  updating_ = false;
  updated_.notify_all();
  if (error) std::rethrow_exception(error);
}

void LazyImageInput::subscribeIfWanted()
{
  const bool wanted = always_subscribe_ || is_wanted_();
  if (wanted && !subscription_)
  {
    // Without this option small packets would wait for each other.
    const image_transport::TransportHints hints("raw", ros::TransportHints().tcpNoDelay(), pnh_);
    diagnostics_.statistics().resumed();
    subscription_ = ImageSubscription(nh_, it_, "image", hints,
                                      [this](const sensor_msgs::ImageConstPtr& message) { onImage(message); });
    diagnostics_.statistics().setRunning(subscription_.topic());
    on_listen_(true);
  }
  else if (!wanted && subscription_)
  {
    subscription_.shutdown();
    diagnostics_.statistics().setIdle();
    on_listen_(false);
  }
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
