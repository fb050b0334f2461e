#include "stereo_input.hpp"

#include <stdexcept>
#include <utility>

#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/images/camera_info.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/stamps.hpp"
#include "ros/images/subscribing_lock.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueueSize = 10;  // camera_info that waits while a pair is processed
const std::array<std::string, 2> kSides = {"left", "right"};

std::string imageName(std::size_t side)
{
  return kSides[side] + "/image_raw";
}

StereoTopics topicsOf(const ros::NodeHandle& nh)
{
  StereoTopics topics;
  for (const std::size_t side : {kLeft, kRight})
  {
    topics.images[side] = nh.resolveName(imageName(side));
    topics.infos[side] = cameraInfoTopic(nh, kSides[side]);
  }
  return topics;
}

/// "/left/image_raw (bgr8, 640x480)".
std::string described(const sensor_msgs::Image& image, const std::string& topic)
{
  return topic + " (" + printable(image.encoding) + ", " + sizeText(image.width, image.height) + ")";
}

/// The pixels of an image. Throws std::invalid_argument that says which one it is.
cv::Mat viewOf(const StereoPair& pair, std::size_t side)
{
  try
  {
    return viewPixels(*pair.images[side]);
  }
  catch (const std::exception& e)
  {
    throw std::invalid_argument("the " + kSides[side] + " image: " + e.what());
  }
}

}  // namespace

StereoInput::StereoInput(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name,
                         Process process, std::function<bool()> is_wanted, std::function<void(bool)> on_listen)
  : nh_(nh),
    name_(name),
    process_(std::move(process)),
    on_listen_(std::move(on_listen)),
    diagnostics_(nh, pnh, name),
    it_(nh),
    hints_(readTransport(it_, pnh)),
    topics_(topicsOf(nh)),
    pairs_(readSlop(pnh, 0.0)),
    subscriber_(nh, pnh, diagnostics_.statistics(), std::move(is_wanted), [this](bool wanted) { listen(wanted); })
{
  for (const std::size_t side : {kLeft, kRight})
    if (topics_.images[side] == "/" + imageName(side))
      ROS_WARN("%s: topic '%s' is not remapped; typical use is %s:=/my_pair/%s", name_.c_str(), imageName(side).c_str(),
               imageName(side).c_str(), imageName(side).c_str());
}

StereoInput::~StereoInput()
{
  subscriber_.stop();  // from now on no connection changes the subscriptions
  unsubscribe();       // waits for the pair in progress, whose results are still published
}

void StereoInput::start()
{
  diagnostics_.statistics().setIdle();
  subscriber_.start();
}

void StereoInput::listen(bool wanted)
{
  if (wanted)
  {
    pairs_.clear();
    diagnostics_.statistics().resumed();
    subscribe();
    diagnostics_.statistics().setRunning(topics_.images[kLeft]);
  }
  else
  {
    unsubscribe();
    diagnostics_.statistics().setIdle();
  }
  on_listen_(wanted);
}

void StereoInput::subscribe()
{
  for (const std::size_t side : {kLeft, kRight})
  {
    infos_[side] =
        subscribeToCameraInfo(nh_, topics_.infos[side], kQueueSize,
                              [this, side](const sensor_msgs::CameraInfoConstPtr& info) { onInfo(side, info); });
    images_[side] =
        ImageSubscription(nh_, it_, imageName(side), hints_,
                          [this, side](const sensor_msgs::ImageConstPtr& message) { onImage(side, message); });
  }
}

void StereoInput::unsubscribe()
{
  for (const std::size_t side : {kLeft, kRight})
  {
    images_[side].shutdown();
    endSubscription(infos_[side]);
  }
  pairs_.clear();
}

void StereoInput::onImage(std::size_t side, const sensor_msgs::ImageConstPtr& message)
{
  if (side == kLeft) diagnostics_.statistics().received(message->header.seq);
  const std::optional<StereoPair> pair = pairs_.add(side, message);
  if (pair) return process(*pair);
  const std::string problem = pairs_.problem(side, topics_);
  if (!problem.empty()) refuse(problem);
}

void StereoInput::onInfo(std::size_t side, const sensor_msgs::CameraInfoConstPtr& message)
{
  const std::optional<StereoPair> pair = pairs_.add(side, message);
  if (pair) process(*pair);
}

void StereoInput::process(const StereoPair& pair)
{
  const auto begin = FrameStatistics::Clock::now();
  try
  {
    process_({pair, {viewOf(pair, kLeft), viewOf(pair, kRight)}, topics_});
    diagnostics_.statistics().published(begin, pair.images[kLeft]->header.stamp);
  }
  catch (const std::exception& e)
  {
    refuse("refused the pair of " + described(*pair.images[kLeft], topics_.images[kLeft]) + " and " +
           described(*pair.images[kRight], topics_.images[kRight]) + ": " + e.what());
  }
}

void StereoInput::refuse(const std::string& what)
{
  diagnostics_.statistics().refused(what);
  if (throttle_.due()) ROS_ERROR("%s: %s", name_.c_str(), what.c_str());
}

}  // namespace robot_vision
