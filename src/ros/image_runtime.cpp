#include "image_runtime.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace robot_vision
{
namespace
{

/// Forgets what is gone, so that a process that makes and drops them for ever does not grow.
template <class T>
void add(std::vector<std::weak_ptr<T>>& all, const std::shared_ptr<T>& one)
{
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& other) { return other.expired(); }), all.end());
  all.push_back(one);
}

template <class T>
void closeAll(const std::vector<std::weak_ptr<T>>& all)
{
  for (const auto& one : all)
    if (const auto alive = one.lock()) alive->close();
}

}  // namespace

ImageRuntime::ImageRuntime(const std::string& name, const ros::M_string& options)
{
  const std::size_t slash = name.rfind('/');
  ros::M_string remappings = options;
  remappings["__ns"] = slash == 0 ? "/" : name.substr(0, slash);
  ros::init(remappings, name.substr(slash + 1), ros::init_options::NoSigintHandler);
  nh_ = std::make_shared<ros::NodeHandle>();  // starts roscpp
  nh_->setCallbackQueue(&queue_);
  it_ = std::make_shared<image_transport::ImageTransport>(*nh_);
  spinner_ = std::make_shared<ros::AsyncSpinner>(1);
  spinner_->start();
}

std::shared_ptr<ImageInbox> ImageRuntime::makeInbox(const ImageInbox::Params& params,
                                                    std::shared_ptr<FrameStatistics> statistics)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (stopped_) throw std::runtime_error("the node has been shut down");
  auto inbox = std::make_shared<ImageInbox>(params, *nh_, it_, std::move(statistics));
  add(inboxes_, inbox);
  return inbox;
}

std::shared_ptr<ImageOutbox> ImageRuntime::makeOutbox(const std::string& topic)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (stopped_) throw std::runtime_error("the node has been shut down");
  auto outbox = std::make_shared<ImageOutbox>(topic, *it_, [this] { connections_changed_ = true; });
  add(outboxes_, outbox);
  return outbox;
}

std::shared_ptr<FrameDiagnostics> ImageRuntime::makeDiagnostics(const std::string& node)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (stopped_) throw std::runtime_error("the node has been shut down");
  diagnostics_.push_back(std::make_shared<FrameDiagnostics>(ros::NodeHandle(), ros::NodeHandle(node), node));
  return diagnostics_.back();
}

bool ImageRuntime::spinOnce()
{
  if (!stopped_) queue_.callAvailable(ros::WallDuration(0.1));
  return !stopped_;
}

void ImageRuntime::stop()
{
  if (stopped_.exchange(true)) return;
  queue_.disable();  // wakes the thread that waits in it
  const std::lock_guard<std::mutex> lock(mutex_);
  closeAll(inboxes_);
  closeAll(outboxes_);
  spinner_->stop();
  diagnostics_.clear();
  it_.reset();  // unloads the transports: at the end of the process that would be too late
  ros::shutdown();
}

}  // namespace robot_vision
