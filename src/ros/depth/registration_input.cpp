#include "registration_input.hpp"

#include <stdexcept>
#include <utility>

#include "ros/images/camera_info.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/subscribing_lock.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueueSize = 1;  // of camera_info, of which the newest one counts

/// Subscribes to the newest calibration.
ros::Subscriber subscribeTo(const ros::NodeHandle& nh, const std::string& topic,
                            sensor_msgs::CameraInfoConstPtr& newest)
{
  const auto keep = [&newest](const sensor_msgs::CameraInfoConstPtr& info) { newest = info; };
  return subscribeToCameraInfo(nh, topic, kQueueSize, keep);
}

}  // namespace

RegistrationTopics::RegistrationTopics(const ros::NodeHandle& nh)
  : depth_image(nh.resolveName("depth/image_raw")),
    depth_info(cameraInfoTopic(nh, "depth")),
    color_image(nh.resolveName("rgb/image_raw")),
    color_info(cameraInfoTopic(nh, "rgb"))
{
}

RegistrationInput::RegistrationInput(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name,
                                     Process process, std::function<bool()> is_wanted,
                                     std::function<void(bool)> on_listen)
  : nh_(nh),
    name_(name),
    process_(std::move(process)),
    on_listen_(std::move(on_listen)),
    diagnostics_(nh, pnh, name),
    it_(nh),
    hints_(readTransport(it_, pnh, "depth_image_transport")),
    color_hints_(readTransport(it_, pnh)),
    topics_(nh),
    subscriber_(nh, pnh, diagnostics_.statistics(), std::move(is_wanted), [this](bool wanted) { listen(wanted); })
{
  if (topics_.depth_image == "/depth/image_raw")
    ROS_WARN(
        "%s: topic 'depth/image_raw' is not remapped, and the node is in no namespace; typical use is in that of a "
        "camera, such as __ns:=/camera",
        name_.c_str());
}

RegistrationInput::~RegistrationInput()
{
  subscriber_.stop();  // from now on no connection changes the subscriptions
  unsubscribe();       // waits for the frame in progress, whose results are still published
}

void RegistrationInput::start()
{
  diagnostics_.statistics().setIdle();
  subscriber_.start();
}

void RegistrationInput::listen(bool wanted)
{
  if (wanted)
  {
    diagnostics_.statistics().resumed();
    subscribe();
    diagnostics_.statistics().setRunning(topics_.depth_image);
  }
  else
  {
    unsubscribe();
    diagnostics_.statistics().setIdle();
  }
  on_listen_(wanted);
}

void RegistrationInput::subscribe()
{
  waiting_ = 0;
  depth_info_subscription_ = subscribeTo(nh_, topics_.depth_info, depth_info_);
  color_info_subscription_ = subscribeTo(nh_, topics_.color_info, color_info_);
  depth_subscription_ = ImageSubscription(nh_, it_, "depth/image_raw", hints_,
                                          [this](const sensor_msgs::ImageConstPtr& message) { onDepth(message); });
}

void RegistrationInput::unsubscribe()
{
  depth_subscription_.shutdown();
  color_subscription_.shutdown();
  endSubscription(depth_info_subscription_);
  endSubscription(color_info_subscription_);
  depth_info_.reset();
  color_info_.reset();
  sized_info_.reset();
  color_size_ = cv::Size();
}

void RegistrationInput::onDepth(const sensor_msgs::ImageConstPtr& message)
{
  const auto begin = FrameStatistics::Clock::now();
  diagnostics_.statistics().received(message->header.seq);
  try
  {
    if (waits()) return;
    if (process(message)) diagnostics_.statistics().published(begin, message->header.stamp);
  }
  catch (const std::exception& e)
  {
    const std::string what = describeRefusal(*message, topics_.depth_image, e.what());
    diagnostics_.statistics().refused(what);
    if (throttle_.due()) ROS_ERROR("%s: %s", name_.c_str(), what.c_str());
  }
}

/// Whether something that a depth image needs may be on its way.
bool RegistrationInput::waits()
{
  forgetOtherSize();
  lookForColorSize();
  const bool complete = depth_info_ && color_info_ && !needsColorSize();
  waiting_ = complete ? 0 : waiting_ + 1;
  return !complete && waiting_ < kMaxWaiting;
}

/// Forgets the size of the color images when their camera was set to another one.
void RegistrationInput::forgetOtherSize()
{
  if (sized_info_ && color_info_ && !haveSameWindow(*sized_info_, *color_info_)) color_size_ = cv::Size();
  sized_info_ = color_info_;
}

/// Whether the color camera's camera_info may be that of the whole sensor, or of images whose size is not known yet.
bool RegistrationInput::needsColorSize() const
{
  return color_info_ && hasWindow(*color_info_) && color_size_.empty();
}

/// Subscribes to the color images as long as their size is needed.
void RegistrationInput::lookForColorSize()
{
  const bool needs = needsColorSize();
  if (needs == static_cast<bool>(color_subscription_)) return;
  color_subscription_.shutdown();
  if (!needs) return;
  const auto note = [this](const sensor_msgs::ImageConstPtr& message)
  { color_size_ = cv::Size(static_cast<int>(message->width), static_cast<int>(message->height)); };
  color_subscription_ = ImageSubscription(nh_, it_, "rgb/image_raw", color_hints_, note);
}

bool RegistrationInput::process(const sensor_msgs::ImageConstPtr& message)
{
  if (!depth_info_) throw std::invalid_argument("nothing has come on " + topics_.depth_info);
  if (!color_info_) throw std::invalid_argument("nothing has come on " + topics_.color_info);
  const cv::Mat image = viewAnyPixels(*message);
  return process_({message, image, ofImages(depth_info_, image.size()), ofImages(color_info_, color_size_),
                   &diagnostics_.statistics()});
}

}  // namespace robot_vision
