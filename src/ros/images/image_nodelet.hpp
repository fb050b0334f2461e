#pragma once

#include <memory>

#include "advertising_lock.hpp"
#include "gated_nodelet.hpp"
#include "lazy_image_input.hpp"
#include "lazy_outputs.hpp"
#include "registration.hpp"
#include "ros/params/live_params.hpp"
#include "ros/params/unknown_params.hpp"

namespace robot_vision
{

/// A nodelet that processes the images of the topic `image` while somebody subscribes to its results. `Work` is what it
/// does:
///
///   Work(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);     // subscriptions and services of its own
///   void configure(const Config& config);                            // throws std::invalid_argument to refuse
///   void advertise(LazyOutputs& outputs);                            // after the first configure()
///   void process(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image, LazyOutputs& outputs);
///
///   void listen(bool listens);  // if it has other inputs or a memory: whether somebody subscribes
///
/// `image` views the pixels of the message; process() throws std::exception to refuse it. The manager of the nodelets
/// calls these functions, and the callbacks of both handles, one after the other. `Input` may be another one with
/// LazyImageInput's functions: process() takes what it gives, and the outputs, and returns what it wants.
template <class Config, class Work, class Input = LazyImageInput>
class ImageNodelet : public GatedNodelet
{
public:
  ~ImageNodelet() override { stop(); }

private:
  void begin() final
  {
    const AdvertisingLock advertising;
    work_ = std::make_unique<Work>(getNodeHandle(), getPrivateNodeHandle());
    params_ = std::make_unique<LiveParams<Config>>(getPrivateNodeHandle(),
                                                   [this](const Config& config) { work_->configure(config); });
    outputs_ = std::make_unique<LazyOutputs>(getPrivateNodeHandle(), [this] { input_->update(); });
    input_ = std::make_unique<Input>(
        getNodeHandle(), getPrivateNodeHandle(), getName(),
        [this](const auto&... frame) { return work_->process(frame..., *outputs_); },
        [this] { return outputs_->areWanted(); }, [this](bool listens) { listen(*work_, listens, 0); });
    input_->statistics().countUnshared([this] { return outputs_->unshared(); });
    work_->advertise(*outputs_);
    input_->start();
    reviewParams(getPrivateNodeHandle());
    registration_ = std::make_unique<Registration>(getPrivateNodeHandle().getNamespace());
  }

  template <class Other>
  static auto listen(Other& work, bool listens, int /*preferred*/) -> decltype(work.listen(listens))
  {
    work.listen(listens);
  }

  template <class Other>
  static void listen(Other& /*work*/, bool /*listens*/, long /*otherwise*/)
  {
  }

  void stop() final
  {
    registration_.reset();
    gate_.close();
    const AdvertisingLock advertising;
    input_.reset();  // waits for a frame that is processed during the end of roscpp
    params_.reset();
    outputs_.reset();
    work_.reset();
  }

  std::unique_ptr<Work> work_;
  std::unique_ptr<LiveParams<Config>> params_;
  std::unique_ptr<LazyOutputs> outputs_;
  std::unique_ptr<Input> input_;
  std::unique_ptr<Registration> registration_;
};

}  // namespace robot_vision
