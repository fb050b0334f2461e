#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "image_nodelet.hpp"
#include "ros/params/fields.hpp"

namespace robot_vision
{

/// Publishes what a filter makes of each image on ~processed_image. `Filter` is a class of the core with apply() and
/// outputEncoding(); a new one is made from the `Params` in each `Config`. Its constructor throws std::invalid_argument
/// to refuse them.
template <class Config, class Params, class Filter>
class FilterWork
{
public:
  FilterWork(const ros::NodeHandle& /*nh*/, const ros::NodeHandle& /*pnh*/) {}

  void configure(const Config& config) { filter_ = std::make_unique<Filter>(filled<Params>(config)); }
  void advertise(LazyOutputs& outputs) { outputs.advertiseImages("processed_image"); }

  void process(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    const auto fill = [&](cv::Mat& out)
    {
      filter_->apply(image, message->encoding, out);
      return Filter::outputEncoding(message->encoding);
    };
    outputs.publishImage("processed_image", message->header, fill);
  }

private:
  std::unique_ptr<Filter> filter_;
};

template <class Config, class Params, class Filter>
using FilterNodelet = ImageNodelet<Config, FilterWork<Config, Params, Filter>>;

}  // namespace robot_vision
