#include "embedded_roscpp_node.hpp"

#include <ros/callback_queue.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "robot_vision/common/range.hpp"
#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxWait = 1.0;  // s, while there is nothing to do
constexpr int kMaxWorkers = 256;  // threads of nodelets

/// Does nothing, but wakes a thread that waits for callbacks.
struct WakeUp : ros::CallbackInterface
{
  CallResult call() override { return Success; }
};

}  // namespace

EmbeddedRoscppNode::EmbeddedRoscppNode(const std::string& name, const ros::M_string& options, const std::string& node,
                                       const std::string& node_uri)
  : node_(node)
{
  const std::size_t slash = name.rfind('/');
  ros::M_string remappings = options;
  remappings["__ns"] = slash == 0 ? "/" : name.substr(0, slash);
  ros::init(remappings, name.substr(slash + 1), ros::init_options::NoSigintHandler);
  nh_ = std::make_shared<ros::NodeHandle>();  // starts roscpp
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

std::shared_ptr<NodeQueue> EmbeddedRoscppNode::makeQueue(const std::string& node, const std::string& diagnostics_topic)
{
  requireRunning();
  const NodeQueue::Process process{subscriptions_, [this] { return held(it_); }, gate_.between()};
  const auto queue = std::make_shared<NodeQueue>(process, node, diagnostics_topic);
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  // Destroyed ones are removed, so that a process in which many nodes come and go does not grow.
  queues_.erase(std::remove_if(queues_.begin(), queues_.end(), [](const auto& other) { return other.expired(); }),
                queues_.end());
  queues_.push_back(queue);
  return queue;
}

std::shared_ptr<NodeletHost> EmbeddedRoscppNode::nodelets()
{
  if (const auto begun = held(nodelets_)) return begun;
  int workers = 0;
  readParam(ros::NodeHandle(node_), "num_worker_threads", workers);
  requireRange("num_worker_threads", workers, 0, kMaxWorkers);
  auto nodelets = std::make_shared<NodeletHost>(static_cast<std::uint32_t>(workers));
  const std::lock_guard<std::mutex> lock(mutex_);
  requireRunning();
  if (!nodelets_) nodelets_ = nodelets;
  return nodelets_;
}

void EmbeddedRoscppNode::noteServices()
{
  held(registration_)->noteServices();
}

void EmbeddedRoscppNode::stop()
{
  if (stopped_.exchange(true)) return;
  std::shared_ptr<Registration> registration;
  std::shared_ptr<NodeletHost> nodelets;
  decltype(queues_) queues;
  {
    const std::lock_guard<std::mutex> lock(mutex_);  // from now on nothing is added
    registration.swap(registration_);
    nodelets.swap(nodelets_);
    queues.swap(queues_);
  }
  registration.reset();
  if (nodelets) nodelets->close();
  for (const auto& queue : queues)
    if (const auto alive = queue.lock()) alive->close();
  subscriptions_->close();
  gate_.close();
  ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<WakeUp>());
  global_spinner_.join();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    it_.reset();  // unloads the transports, for which the end of the process would be too late
  }
  ros::shutdown();
}

}  // namespace robot_vision
