#include "nodelet_host.hpp"

#include <nodelet/detail/callback_queue_manager.h>
#include <pluginlib/class_loader.hpp>

#include <boost/make_shared.hpp>
#include <stdexcept>
#include <utility>

#include "advertising_lock.hpp"
#include "nodelet_queue.hpp"

namespace robot_vision
{

/// Makes nodelets by the names of their types.
class NodeletHost::Types
{
public:
  boost::shared_ptr<nodelet::Nodelet> make(const std::string& type)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!classes_->isClassAvailable(type)) classes_->refreshDeclaredClasses();  // it may have come since
    return classes_->createInstance(type);
  }

  std::vector<std::string> names()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return classes_->getDeclaredClasses();
  }

private:
  using Classes = pluginlib::ClassLoader<nodelet::Nodelet>;

  std::mutex mutex_;  // guards all below
  // Never destroyed: the code of the libraries frees the frames that somebody still holds.
  Classes* classes_ = new Classes("nodelet", "nodelet::Nodelet");
};

/// The threads for the nodelets' callbacks.
class NodeletHost::Workers
{
public:
  explicit Workers(std::uint32_t count) : manager_(count) {}
  nodelet::detail::CallbackQueueManager& manager() { return manager_; }

private:
  nodelet::detail::CallbackQueueManager manager_;
};

/// A nodelet with its two queues, one of which is worked through by one thread at a time.
class NodeletHost::Loaded
{
public:
  Loaded(boost::shared_ptr<nodelet::Nodelet> nodelet, nodelet::detail::CallbackQueueManager& manager)
    : manager_(manager),
      one_(boost::make_shared<NodeletQueue>(manager)),
      several_(boost::make_shared<NodeletQueue>(manager)),
      nodelet_(std::move(nodelet))
  {
  }

  ~Loaded()
  {
    if (!started_) return;
    manager_.removeQueue(one_);
    manager_.removeQueue(several_);
  }

  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;

  /// Callbacks wait for the end of onInit().
  void start(const std::string& name, const nodelet::M_string& remappings, const nodelet::V_string& arguments)
  try
  {
    nodelet_->init(name, remappings, arguments, one_.get(), several_.get());
    started_ = true;
    one_->open(false);
    several_->open(true);
  }
  catch (const std::exception& e)
  {
    throw std::runtime_error(e.what());
  }
  catch (...)  // nodelets are others' code
  {
    throw std::runtime_error("the nodelet has thrown what is no exception");
  }

private:
  nodelet::detail::CallbackQueueManager& manager_;
  boost::shared_ptr<NodeletQueue> one_;
  boost::shared_ptr<NodeletQueue> several_;
  bool started_ = false;
  boost::shared_ptr<nodelet::Nodelet> nodelet_;  // goes first
};

NodeletHost::NodeletHost(std::uint32_t workers)
  : types_(std::make_unique<Types>()), workers_(std::make_unique<Workers>(workers))
{
}

NodeletHost::~NodeletHost()
{
  close();
}

void NodeletHost::load(const std::string& name, const std::string& type, const nodelet::M_string& remappings,
                       const nodelet::V_string& arguments)
{
  const std::lock_guard<std::mutex> starting(starting_);
  const auto require_free = [&]
  {
    if (closed_) throw std::runtime_error("the node has been shut down");
    if (loaded_.count(name) != 0) throw std::runtime_error("a nodelet of the name " + name + " is loaded already");
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    require_free();
  }
  const AdvertisingLock advertising;
  const auto loaded = std::make_shared<Loaded>(types_->make(type), workers_->manager());
  loaded->start(name, remappings, arguments);
  const std::lock_guard<std::mutex> lock(mutex_);
  require_free();  // close() does not wait for a nodelet that starts
  loaded_[name] = loaded;
}

bool NodeletHost::unload(const std::string& name)
{
  const std::lock_guard<std::mutex> starting(starting_);
  const AdvertisingLock advertising;
  std::shared_ptr<Loaded> ending;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = loaded_.find(name);
  if (found == loaded_.end()) return false;
  ending = std::move(found->second);
  loaded_.erase(found);
  return true;
}

std::vector<std::string> NodeletHost::names() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, loaded] : loaded_)
    names.push_back(name);
  return names;
}

std::vector<std::string> NodeletHost::types()
{
  return types_->names();
}

void NodeletHost::close()
{
  const AdvertisingLock advertising;
  decltype(loaded_) ending;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    ending.swap(loaded_);
  }
}

}  // namespace robot_vision
