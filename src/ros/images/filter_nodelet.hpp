#pragma once

#include <nodelet/nodelet.h>

#include <memory>
#include <mutex>
#include <string>

#include "callback_gate.hpp"
#include "lazy_image_filter.hpp"
#include "registration.hpp"
#include "robot_vision/common/printable.hpp"
#include "ros/params/fields.hpp"
#include "ros/params/live_params.hpp"
#include "ros/params/unknown_params.hpp"

namespace robot_vision
{

/// A nodelet that filters images. `Filter` is a class of the core with apply() and outputEncoding(); a new one is made
/// from the `Params` in each `Config`. Its constructor throws std::invalid_argument to refuse them.
template <class Config, class Params, class Filter>
class FilterNodelet : public nodelet::Nodelet
{
public:
  ~FilterNodelet() override { stop(); }

private:
  void onInit() override
  try
  {
    gate_.guard(getNodeHandle());
    gate_.guard(getPrivateNodeHandle());
    const auto renew = [this](const Config& config)
    {
      auto filter = std::make_shared<Filter>(filled<Params>(config));
      const std::lock_guard<std::mutex> lock(mutex_);
      filter_ = filter;
    };
    params_ = std::make_unique<LiveParams<Config>>(getPrivateNodeHandle(), renew);
    const auto apply = [this](const cv::Mat& image, const std::string& encoding, cv::Mat& out)
    { current()->apply(image, encoding, out); };
    image_filter_ = std::make_unique<LazyImageFilter>(getNodeHandle(), getPrivateNodeHandle(), getName(),
                                                      LazyImageFilter::Step{&Filter::outputEncoding, apply});
    reviewParams(getPrivateNodeHandle());
    registration_ = std::make_unique<Registration>(getPrivateNodeHandle().getNamespace());
  }
  catch (const std::exception& e)
  {
    NODELET_FATAL("%s: %s", getName().c_str(), logLine(e.what()).c_str());
    stop();  // here, because the loader destroys the callback queues before the nodelet
    throw;   // so that the loader reports a failure instead of keeping a dead nodelet
  }

  void stop()
  {
    registration_.reset();
    gate_.close();
    image_filter_.reset();
    params_.reset();
  }

  std::shared_ptr<Filter> current()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return filter_;
  }

  CallbackGate gate_;  // must be destroyed last, because roscpp uses its queues
  std::mutex mutex_;   // guards filter_, which new parameters may replace while a frame uses it
  std::shared_ptr<Filter> filter_;
  std::unique_ptr<LiveParams<Config>> params_;
  std::unique_ptr<LazyImageFilter> image_filter_;
  std::unique_ptr<Registration> registration_;
};

}  // namespace robot_vision
