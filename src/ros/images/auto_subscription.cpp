#include "auto_subscription.hpp"

#include <robot_vision/ShmImage.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <utility>

#include "frame_handover.hpp"
#include "growing_pause.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/shared_instance.hpp"
#include "robot_vision/common/throttle.hpp"
#include "shared_image.hpp"
#include "shared_offers.hpp"
#include "subscription_pair.hpp"
#include "topic_publishers.hpp"

namespace robot_vision
{
namespace
{

using Clock = std::chrono::steady_clock;
using Way = FrameHandover::Way;

constexpr std::chrono::seconds kMixedPause(5);  // until it is seen again whether all publishers offer shm
constexpr std::chrono::seconds kMinFaultPause(1), kMaxFaultPause(32);  // where not all that offer shm can be read
constexpr std::chrono::seconds kUnofferedTimeout(3);  // after which it is told that no publisher offers shm

}  // namespace

class AutoSubscription::State : public SubscriptionWatch::Watched, public std::enable_shared_from_this<State>
{
public:
  State(const ros::NodeHandle& nh, const Params& params, const Callback& callback, std::function<void()> wake_watch)
    : pair_(nh, {params.topic, params.queue_size, params.hints, params.tracked_object}),
      wants_shared_(params.wants_shared),
      callback_(callback),
      wake_watch_(std::move(wake_watch)),
      images_(pair_.topic()),
      offers_(pair_.topic())
  {
  }

  std::uint32_t publishers() const;
  bool isShared() const { return handover_.way() == Way::kShared; }
  void open();
  void review() override;
  void close();

private:
  /// A callback after which the object may end, because the user ends the subscription in there.
  template <class Message>
  boost::function<void(const boost::shared_ptr<const Message>&)> whileAlive(
      void (State::*callback)(const boost::shared_ptr<const Message>&))
  {
    return [weak = weak_from_this(), callback](const boost::shared_ptr<const Message>& message)
    {
      const SubscriptionWatch::Callback inside;
      if (const std::shared_ptr<State> alive = weak.lock()) (alive.get()->*callback)(message);
    };
  }

  void subscribeRaw();
  void subscribeShared();

  void onRaw(const sensor_msgs::ImageConstPtr& image);
  void onShared(const boost::shared_ptr<const ShmImage>& message);
  void deliver(Way way, const sensor_msgs::ImageConstPtr& image, std_msgs::Header* own);
  void onFault(const SharedMemoryError& error);

  void decide(Clock::time_point now);
  void useRaw(bool at_once);
  void follow(Clock::time_point now);
  void judge(std::uint32_t connections, Clock::time_point now);
  void warn(const std::string& reason);

  SubscriptionPair pair_;
  const bool wants_shared_;
  const Callback callback_;
  const std::function<void()> wake_watch_;
  FrameHandover handover_;
  SharedImages images_;
  std::atomic<bool> faulty_{false};    // frames could not be read since the last review
  std::atomic<bool> readable_{false};  // frames could be read since the last fault
  std::atomic<bool> warned_{false};

  // Only the thread that reviews uses these.
  GrowingPause fault_pause_{kMinFaultPause, kMaxFaultPause};
  Clock::time_point mixed_until_;
  Clock::time_point shared_since_;  // when the subscription to shm began
  SharedOffers offers_;
  Throttle refused_;

  std::mutex mutex_;  // guards all below
  std::condition_variable reviewed_;
  bool closed_ = false, reviewing_ = false;
};

void AutoSubscription::State::subscribeRaw()
{
  pair_.openRaw(whileAlive(&State::onRaw));
}

void AutoSubscription::State::subscribeShared()
{
  if (pair_.openShared(whileAlive(&State::onShared))) shared_since_ = Clock::now();
}

std::uint32_t AutoSubscription::State::publishers() const
{
  return pair_.publishers(handover_.way());
}

void AutoSubscription::State::open()
{
  subscribeRaw();  // in any case, because a publisher may have latched an image for those that subscribe to raw
  if (!isPublishedHere(pair_.topic())) subscribeShared();
}

void AutoSubscription::State::close()
{
  const bool waits = handover_.close();
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (std::exchange(closed_, true)) return;
    if (waits) reviewed_.wait(lock, [this] { return !reviewing_; });
  }
  pair_.close();
  const bool was_raw = pair_.drop(Way::kRaw), was_shared = pair_.drop(Way::kShared);
  if (was_shared && !was_raw) forgetSubscription(pair_.topic(), ros::message_traits::datatype<sensor_msgs::Image>());
}

void AutoSubscription::State::onRaw(const sensor_msgs::ImageConstPtr& image)
{
  deliver(Way::kRaw, image, nullptr);
}

void AutoSubscription::State::onShared(const boost::shared_ptr<const ShmImage>& message)
{
  if (!handover_.accepts(Way::kShared)) return;
  sensor_msgs::ImagePtr image;
  try
  {
    image = images_.hold(*message);
    readable_ = true;
  }
  catch (const SharedMemoryError& error)
  {
    return onFault(error);
  }
  deliver(Way::kShared, image, &image->header);
}

void AutoSubscription::State::onFault(const SharedMemoryError& error)
{
  if (error.concernsOneFrame()) return;  // the next one comes
  if (error.fault() != SharedMemoryFault::kGone) warn(error.what());
  handover_.allow(std::nullopt);
  faulty_ = true;
  wake_watch_();
}

/// `own`: the header, if it may be written.
void AutoSubscription::State::deliver(Way way, const sensor_msgs::ImageConstPtr& image, std_msgs::Header* own)
{
  const bool changes = handover_.way() != way;
  if (handover_.begin(way, image->header))
  {
    struct Finish  // also when the callback throws
    {
      ~Finish() { handover.finish(); }
      FrameHandover& handover;
    } const finish{handover_};
    if (own != nullptr) own->seq = handover_.sequence(image->header);
    callback_(image);
  }
  if (!changes || handover_.way() != way) return;
  wake_watch_();  // which ends the other subscription
}

void AutoSubscription::State::review()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_ || ros::isShuttingDown()) return;
    reviewing_ = true;
  }
  try
  {
    images_.forgetEnded();
    decide(Clock::now());
  }
  catch (const ros::Exception& error)  // somebody in this process subscribes to the topic as one of another type
  {
    if (refused_.due()) ROS_ERROR("%s: %s", pair_.topic().c_str(), error.what());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  reviewing_ = false;
  reviewed_.notify_all();
}

void AutoSubscription::State::decide(Clock::time_point now)
{
  if (faulty_.exchange(false)) fault_pause_.begin(now, readable_.exchange(false));
  if (isPublishedHere(pair_.topic()) || fault_pause_.isOn(now) || now < mixed_until_)
    useRaw(true);
  else
    follow(now);
}

/// Has images come over raw, at once or when the first one has come so.
void AutoSubscription::State::useRaw(bool at_once)
{
  subscribeRaw();
  if (at_once)
    handover_.take(Way::kRaw);
  else
    handover_.allow(Way::kRaw);
  if (handover_.way() == Way::kRaw) pair_.drop(Way::kShared);
  offers_.forget();
}

void AutoSubscription::State::follow(Clock::time_point now)
{
  subscribeShared();
  const std::uint32_t connections = pair_.publishers(Way::kShared);
  if (connections == 0)
  {
    subscribeRaw();
    handover_.take(Way::kRaw);
    offers_.forget();
    const bool is_late = now - shared_since_ > kUnofferedTimeout;
    if (is_late && pair_.publishers(Way::kRaw) > 0) warn("no publisher of it offers shm");
    return;
  }
  judge(connections, now);
  if (handover_.way() != Way::kShared || !pair_.drop(Way::kRaw)) return;
  offers_.renew();  // the end of that subscription has ended the registration, which a question renews
  judge(connections, now);
}

void AutoSubscription::State::judge(std::uint32_t connections, Clock::time_point now)
{
  const SharedOffers::Answer answer = offers_.ask(connections, now);
  if (answer == SharedOffers::Answer::kAll && !faulty_) handover_.allow(Way::kShared);
  if (answer != SharedOffers::Answer::kNotAll) return;
  warn("a publisher of it does not offer shm");
  mixed_until_ = now + kMixedPause;
  useRaw(false);
}

void AutoSubscription::State::warn(const std::string& reason)
{
  if (wants_shared_ && !warned_.exchange(true))
    ROS_WARN("%s: images come over raw, not shm: %s", pair_.topic().c_str(), printable(reason, 300).c_str());
}

AutoSubscription::AutoSubscription(const ros::NodeHandle& nh, const Params& params, const Callback& callback)
  : topic_(nh.resolveName(params.topic)),
    watch_(sharedInstance<SubscriptionWatch>()),
    state_(std::make_shared<State>(nh, params, callback, watch_->waker()))
{
  state_->open();
  watch_->add(state_);
}

std::uint32_t AutoSubscription::publishers() const
{
  return state_->publishers();
}

bool AutoSubscription::isShared() const
{
  return state_->isShared();
}

void AutoSubscription::shutdown()
{
  state_->close();
}

}  // namespace robot_vision
