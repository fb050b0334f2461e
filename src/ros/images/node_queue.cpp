#include "node_queue.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "advertising_lock.hpp"

namespace robot_vision
{

NodeQueue::NodeQueue(Process process, std::string node, std::string diagnostics_topic)
  : process_(std::move(process)),
    node_(std::move(node)),
    diagnostics_topic_(std::move(diagnostics_topic)),
    queue_(Wake{waker_})
{
  connections_->waker = waker_;
  nh_.setCallbackQueue(&queue_);
  gate_.guard(nh_);
}

/// Adds an object to those that close() closes. Destroyed ones are removed, so that a node that makes and drops many
/// does not grow.
template <class T>
void NodeQueue::add(std::vector<std::weak_ptr<T>>& all, const std::shared_ptr<T>& one)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& other) { return other.expired(); }), all.end());
  all.push_back(one);
}

void NodeQueue::requireRunning() const
{
  if (closed_) throw std::runtime_error("the node has been shut down");
}

std::shared_ptr<LatestImageSubscriber> NodeQueue::makeInbox(const LatestImageSubscriber::Params& params,
                                                            std::shared_ptr<FrameStatistics> statistics)
{
  requireRunning();
  if (params.transport != "raw") requireTransport(*process_.transports(), params.transport);
  const LatestImageSubscriber::Node node{nh_, process_.subscriptions, waker_};
  const auto inbox = std::make_shared<LatestImageSubscriber>(params, node, std::move(statistics));
  add(subscribers_, inbox);
  return inbox;
}

std::shared_ptr<PooledImagePublisher> NodeQueue::makeOutbox(const std::string& topic)
{
  requireRunning();
  const auto changed = [connections = connections_] { connections->note(); };
  const auto outbox = std::make_shared<PooledImagePublisher>(topic, *process_.transports(), changed, process_.between);
  add(publishers_, outbox);
  add(shared_topics_, outbox->sharedTopic());
  return outbox;
}

std::shared_ptr<FrameStatistics> NodeQueue::makeStatistics()
{
  const ros::NodeHandle nh("/", {{"/diagnostics", diagnostics_topic_}});
  const AdvertisingLock advertising;
  auto diagnostics = std::make_unique<FrameDiagnostics>(nh, ros::NodeHandle(node_), node_);
  diagnostics->statistics().countUnshared([this] { return unshared(); });  // close() ends the reports
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  diagnostics_.push_back(std::move(diagnostics));
  return diagnostics_.back()->shared();
}

std::uint64_t NodeQueue::unshared()
{
  std::vector<std::shared_ptr<SharedTopic>> topics;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& topic : shared_topics_)
    if (auto alive = topic.lock()) topics.push_back(std::move(alive));
  return droppedOf(topics);
}

std::optional<NodeQueue::Delivery> NodeQueue::next(double timeout_s)
{
  const auto timeout = std::chrono::duration_cast<Waker::Clock::duration>(std::chrono::duration<double>(timeout_s));
  const Waker::Clock::time_point deadline = Waker::Clock::now() + timeout;
  do
  {
    queue_.callAvailable(ros::WallDuration(0));
    if (!running() || connections_->changed) return std::nullopt;
    std::optional<Delivery> delivery = takeNext();
    if (delivery) return running() ? std::move(delivery) : std::nullopt;
    if (interrupted_.exchange(false)) return std::nullopt;
  } while (waker_->waitUntil(deadline));
  return std::nullopt;
}

std::optional<NodeQueue::Delivery> NodeQueue::takeNext()
{
  decltype(subscribers_) subscribers;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    subscribers = subscribers_;
  }
  for (std::size_t tried = 0; tried < subscribers.size(); ++tried)
  {
    turn_ = (turn_ + 1) % subscribers.size();
    const std::shared_ptr<LatestImageSubscriber> subscriber = subscribers[turn_].lock();
    if (!subscriber) continue;
    std::optional<ReceivedImage> image = subscriber->take();
    if (image) return Delivery{subscriber, std::move(*image)};
  }
  return std::nullopt;
}

void NodeQueue::interrupt()
{
  interrupted_ = true;
  waker_->wake();
}

void NodeQueue::noteConnections()
{
  connections_->note();
}

void NodeQueue::close()
{
  decltype(subscribers_) subscribers;
  decltype(publishers_) publishers;
  decltype(diagnostics_) diagnostics;
  {
    const std::lock_guard<std::mutex> lock(mutex_);  // from now on nothing is added
    if (closed_.exchange(true)) return;
    std::swap(subscribers, subscribers_);
    std::swap(publishers, publishers_);
    std::swap(diagnostics, diagnostics_);
  }
  waker_->wake();
  gate_.close();
  for (const auto& subscriber : subscribers)
    if (const auto alive = subscriber.lock()) alive->end();
  for (const auto& publisher : publishers)
    if (const auto alive = publisher.lock()) alive->close();
  const AdvertisingLock advertising;
  diagnostics.clear();
}

}  // namespace robot_vision
