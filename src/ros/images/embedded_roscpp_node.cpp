#include "embedded_roscpp_node.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace robot_vision
{
namespace
{

template <class T>
void closeAll(const std::vector<std::weak_ptr<T>>& all)
{
  for (const auto& one : all)
    if (const auto alive = one.lock()) alive->close();
}

constexpr double kMaxWait = 1.0;  // s, while there is nothing to do

/// Does nothing, but wakes a thread that waits for callbacks.
struct WakeUp : ros::CallbackInterface
{
  CallResult call() override { return Success; }
};

}  // namespace

EmbeddedRoscppNode::EmbeddedRoscppNode(const std::string& name, const ros::M_string& options, const std::string& node,
                                       const std::string& node_uri)
{
  const std::size_t slash = name.rfind('/');
  ros::M_string remappings = options;
  remappings["__ns"] = slash == 0 ? "/" : name.substr(0, slash);
  ros::init(remappings, name.substr(slash + 1), ros::init_options::NoSigintHandler);
  nh_ = std::make_shared<ros::NodeHandle>();  // starts roscpp
  nh_->setCallbackQueue(&queue_);
  gate_.guard(*nh_);
  it_ = std::make_shared<image_transport::ImageTransport>(*nh_);
  global_spinner_ = std::thread(
      [this]
      {
        while (running())
          ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kMaxWait));
      });
  registration_ = std::make_shared<Registration>(name, node, node_uri);
}

/// Adds an object to those that stop() closes. Destroyed ones are removed, so that a process that makes and drops many
/// does not grow.
template <class T>
std::shared_ptr<T> EmbeddedRoscppNode::add(std::vector<std::weak_ptr<T>>& all, std::shared_ptr<T> one)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& other) { return other.expired(); }), all.end());
  all.push_back(one);
  return one;
}

/// A copy of a pointer that stop() resets.
template <class T>
std::shared_ptr<T> EmbeddedRoscppNode::held(const std::shared_ptr<T>& member)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  return member;
}

void EmbeddedRoscppNode::requireRunning() const
{
  if (stopped_) throw std::runtime_error("the node has been shut down");
}

std::shared_ptr<LatestImageSubscriber> EmbeddedRoscppNode::makeInbox(const LatestImageSubscriber::Params& params,
                                                                     std::shared_ptr<FrameStatistics> statistics)
{
  return add(subscribers_, std::make_shared<LatestImageSubscriber>(params, *nh_, held(it_), std::move(statistics)));
}

std::shared_ptr<PooledImagePublisher> EmbeddedRoscppNode::makeOutbox(const std::string& topic)
{
  const auto changed = [this] { connections_changed_ = true; };
  const auto publisher = add(publishers_, std::make_shared<PooledImagePublisher>(topic, *held(it_), changed));
  held(registration_)->look();  // because the transports have advertised services
  return publisher;
}

std::shared_ptr<FrameDiagnostics> EmbeddedRoscppNode::makeDiagnostics(const std::string& node)
{
  auto diagnostics = std::make_shared<FrameDiagnostics>(ros::NodeHandle(), ros::NodeHandle(node), node);
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  diagnostics_.push_back(diagnostics);
  return diagnostics;
}

std::optional<EmbeddedRoscppNode::Delivery> EmbeddedRoscppNode::next(double timeout_s)
{
  for (const double wait_s : {0.0, timeout_s})
  {
    queue_.callAvailable(ros::WallDuration(wait_s));
    if (!running() || connections_changed_) return std::nullopt;
    std::optional<Delivery> delivery = takeNext();
    if (delivery) return delivery;
  }
  return std::nullopt;
}

std::optional<EmbeddedRoscppNode::Delivery> EmbeddedRoscppNode::takeNext()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t tried = 0; tried < subscribers_.size(); ++tried)
  {
    turn_ = (turn_ + 1) % subscribers_.size();
    const std::shared_ptr<LatestImageSubscriber> subscriber = subscribers_[turn_].lock();
    if (!subscriber) continue;
    std::optional<ReceivedImage> image = subscriber->take();
    if (image) return Delivery{subscriber, std::move(*image)};
  }
  return std::nullopt;
}

void EmbeddedRoscppNode::noteConnections()
{
  connections_changed_ = true;
  queue_.addCallback(boost::make_shared<WakeUp>());
}

void EmbeddedRoscppNode::stop()
{
  if (stopped_.exchange(true)) return;
  std::shared_ptr<Registration> registration;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    registration.swap(registration_);
  }
  registration.reset();
  queue_.disable();  // wakes the thread in next()
  gate_.close();
  decltype(subscribers_) subscribers;
  decltype(publishers_) publishers;
  {
    const std::lock_guard<std::mutex> lock(mutex_);  // from now on nothing is added
    std::swap(subscribers, subscribers_);
    std::swap(publishers, publishers_);
  }
  closeAll(subscribers);
  closeAll(publishers);
  ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<WakeUp>());
  global_spinner_.join();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    diagnostics_.clear();
    it_.reset();  // unloads the transports, for which the end of the process would be too late
  }
  ros::shutdown();
}

}  // namespace robot_vision
