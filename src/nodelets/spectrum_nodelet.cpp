#include <geometry_msgs/Vector3Stamped.h>
#include <robot_vision/SpectrumConfig.h>

#include <boost/make_shared.hpp>
#include <cstdio>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "factories.hpp"
#include "robot_vision/image/overlay.hpp"
#include "robot_vision/spectrum/spectrum.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/params/fields.hpp"

namespace robot_vision
{
namespace
{

/// Publishes the spectrum of each frame, the frame with some of its frequencies, and its shift since the last frame.
class SpectrumWork
{
public:
  SpectrumWork(const ros::NodeHandle& /*nh*/, const ros::NodeHandle& /*pnh*/) {}

  void configure(const SpectrumConfig& config)
  {
    const auto params = filled<SpectrumParams>(config);
    filter_ = std::make_unique<FrequencyFilter>(params);  // refuses bad ones, before anything has changed
    // Other filters and pictures do not begin anew.
    if (!correlator_ || params.min_response != params_.min_response || params.max_gap != params_.max_gap)
      correlator_ = std::make_unique<PhaseCorrelator>(params);
    params_ = params;
  }

  static void advertise(LazyOutputs& outputs)
  {
    outputs.advertiseImages("magnitude");
    outputs.advertiseImages("filtered");
    outputs.advertiseImages("processed_image");
    outputs.advertise<geometry_msgs::Vector3Stamped>("shift");
  }

  /// After a time without subscribers the first frame has no shift from the last one before.
  void listen(bool listens)
  {
    if (!listens) correlator_->reset();
  }

  void process(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    const std::optional<ImageShift> shift = publishShift(*message, image, outputs);
    publishFiltered(*message, image, outputs);
    if (!outputs.isWanted("magnitude") && !outputs.isWanted("processed_image")) return;
    const cv::Mat spectrum = spectrumImage(spectrumMagnitude(image, message->encoding, params_));
    if (outputs.isWanted("magnitude"))
      outputs.publishImage("magnitude", message->header,
                           [&](cv::Mat& out)
                           {
                             spectrum.copyTo(out);
                             return "mono8";
                           });
    if (outputs.isWanted("processed_image"))
      outputs.publishImage("processed_image", message->header,
                           [&](cv::Mat& out)
                           {
                             cv::cvtColor(spectrum, out, cv::COLOR_GRAY2BGR);
                             drawPassband(out, params_);
                             if (shift) drawText(out, textOf(*shift), {8, out.rows - 10});
                             return "bgr8";
                           });
  }

private:
  /// The shift, if somebody looks at it; else the next one that is looked at has no frame before.
  std::optional<ImageShift> publishShift(const sensor_msgs::Image& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    if (!outputs.isWanted("shift") && !outputs.isWanted("processed_image"))
    {
      correlator_->reset();
      return std::nullopt;
    }
    const auto shift = correlator_->update(message.header.stamp.toSec(), image, message.encoding);
    if (shift && shift->found && outputs.isWanted("shift"))
    {
      const auto vector = boost::make_shared<geometry_msgs::Vector3Stamped>();
      vector->header = message.header;
      vector->vector.x = shift->x;
      vector->vector.y = shift->y;
      outputs.publish("shift", vector);
    }
    return shift;
  }

  void publishFiltered(const sensor_msgs::Image& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    if (!outputs.isWanted("filtered")) return;
    outputs.publishImage("filtered", message.header,
                         [&](cv::Mat& out)
                         {
                           filter_->apply(image, message.encoding, filtered_);
                           filter_->show(filtered_, out);
                           return "mono8";
                         });
  }

  static std::string textOf(const ImageShift& shift)
  {
    char text[80];
    if (shift.found)
      std::snprintf(text, sizeof(text), "shift %.1f %.1f px, response %.2f", shift.x, shift.y, shift.response);
    else
      std::snprintf(text, sizeof(text), "no shift, response %.2f", shift.response);
    return text;
  }

  SpectrumParams params_;
  std::unique_ptr<FrequencyFilter> filter_;
  std::unique_ptr<PhaseCorrelator> correlator_;
  cv::Mat filtered_;
};

using SpectrumNodelet = ImageNodelet<SpectrumConfig, SpectrumWork>;

}  // namespace

boost::shared_ptr<nodelet::Nodelet> makeSpectrum()
{
  return boost::make_shared<SpectrumNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::SpectrumNodelet, nodelet::Nodelet)
