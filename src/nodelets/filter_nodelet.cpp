#include <robot_vision/FilterConfig.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "factories.hpp"
#include "robot_vision/common/throttle.hpp"
#include "robot_vision/filters/filter_chain.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/images/image_subscription.hpp"
#include "ros/params/param_values.hpp"

namespace robot_vision
{
namespace
{

/// The topics of the steps of a chain: steps/NAME, and steps/NAME_2 where an operation occurs for the second time.
std::vector<std::string> stepTopics(const std::vector<std::string>& names)
{
  std::vector<std::string> topics;
  for (auto name = names.begin(); name != names.end(); ++name)
  {
    const auto number = std::count(names.begin(), name + 1, *name);
    topics.push_back("steps/" + *name + (number > 1 ? "_" + std::to_string(number) : ""));
  }
  return topics;
}

}  // namespace

/// Publishes what a chain of operations makes of `image` on ~processed_image, and what each of them makes on
/// ~steps/NAME. The other image of operations on two is the newest one of `second` if ~use_second is set.
class ChainWork
{
public:
  ChainWork(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) : nh_(nh), it_(nh), hints_(readTransport(it_, pnh))
  {
  }

  void configure(const FilterConfig& config)
  {
    dynamic_reconfigure::Config message;
    config.__toMessage__(message);
    ParamValues values = paramValues(message);
    values.erase("chain");
    values.erase("use_second");
    const std::vector<std::string> names = chainNames(config.chain);
    FilterChain chain(names, values);
    const bool uses_second = config.use_second && chain.takesSecond();
    subscribe(uses_second && listens_);  // may throw, so before anything changes
    setTopics(stepTopics(names));
    chain_ = std::move(chain);
    uses_second_ = uses_second;
  }

  void advertise(LazyOutputs& outputs)
  {
    outputs_ = &outputs;
    outputs.advertiseImages("processed_image");
    setTopics(topics_);
  }

  void listen(bool listens)
  {
    subscribe(uses_second_ && listens);
    listens_ = listens;
  }

  void process(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    const auto on_step = [&](std::size_t step, const EncodedImage& result)
    {
      if (!outputs.isWanted(topics_[step])) return;
      const auto copy = [&result](cv::Mat& out)
      {
        result.pixels.copyTo(out);
        return result.encoding;
      };
      outputs.publishImage(topics_[step], message->header, copy);
    };
    const EncodedImage other = uses_second_ ? newestSecond() : EncodedImage();
    const auto fill = [&](cv::Mat& out) { return chain_.apply({image, message->encoding}, out, other, on_step); };
    outputs.publishImage("processed_image", message->header, fill);
  }

private:
  /// To the topic `second`, or ends that.
  void subscribe(bool wanted)
  {
    if (wanted && !subscription_)
    {
      subscription_ = ImageSubscription(nh_, it_, "second", hints_,
                                        [this](const sensor_msgs::ImageConstPtr& message) { keep(message); });
    }
    else if (!wanted)
    {
      subscription_.shutdown();
      second_.reset();
    }
  }

  /// The newest image of `second`. Throws std::runtime_error if there is none.
  EncodedImage newestSecond()
  {
    if (subscription_.publishers() == 0)
    {
      second_.reset();  // it would be laid over all images to come
      throw std::runtime_error("nobody publishes the other image on " + subscription_.topic());
    }
    if (!second_) throw std::runtime_error("no image has come on " + subscription_.topic() + " yet");
    return {viewPixels(*second_), second_->encoding};
  }

  /// As the second image, if it can be one.
  void keep(const sensor_msgs::ImageConstPtr& message)
  {
    try
    {
      viewPixels(*message);
      second_ = message;
    }
    catch (const std::exception& e)
    {
      if (throttle_.due()) ROS_ERROR("%s", describeRefusal(*message, subscription_.topic(), e.what()).c_str());
    }
  }

  /// Topics that stay keep their subscribers.
  void setTopics(std::vector<std::string> topics)
  {
    const std::vector<std::string> before = std::exchange(topics_, std::move(topics));
    if (!outputs_) return;
    for (const std::string& topic : before)
      if (std::count(topics_.begin(), topics_.end(), topic) == 0) outputs_->withdraw(topic);
    for (const std::string& topic : topics_)
      outputs_->advertiseImages(topic);
  }

  ros::NodeHandle nh_;
  image_transport::ImageTransport it_;
  const image_transport::TransportHints hints_;
  FilterChain chain_{{}};
  std::vector<std::string> topics_;  // of the steps
  LazyOutputs* outputs_ = nullptr;   // null before advertise()
  sensor_msgs::ImageConstPtr second_;
  Throttle throttle_;
  bool uses_second_ = false;
  bool listens_ = false;
  ImageSubscription subscription_;  // to the topic `second`
};

using ChainNodelet = ImageNodelet<FilterConfig, ChainWork>;

boost::shared_ptr<nodelet::Nodelet> makeFilter()
{
  return boost::make_shared<ChainNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::ChainNodelet, nodelet::Nodelet)
