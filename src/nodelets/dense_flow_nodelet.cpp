#include <geometry_msgs/Vector3Stamped.h>
#include <robot_vision/DenseFlowConfig.h>

#include <boost/make_shared.hpp>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "factories.hpp"
#include "robot_vision/flow/dense_flow.hpp"
#include "robot_vision/flow/flow_drawing.hpp"
#include "robot_vision/image/encoding.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/params/fields.hpp"

namespace robot_vision
{
namespace
{

/// Publishes the flow from the last frame to this one on ~flow, its mean and median, and a drawing of it.
class DenseFlowWork
{
public:
  DenseFlowWork(const ros::NodeHandle& /*nh*/, const ros::NodeHandle& /*pnh*/) {}

  void configure(const DenseFlowConfig& config)
  {
    const auto params = filled<DenseFlowParams>(config);
    const auto drawing = filled<FlowDrawingParams>(config);
    validate(drawing);
    // Another way of drawing does not begin anew.
    if (!finder_ || !equalFields(params, params_)) finder_ = std::make_unique<DenseFlow>(params);
    params_ = params;
    drawing_ = drawing;
  }

  static void advertise(LazyOutputs& outputs)
  {
    outputs.advertiseImages("flow");
    outputs.advertiseImages("processed_image");
    outputs.advertise<geometry_msgs::Vector3Stamped>("mean");
    outputs.advertise<geometry_msgs::Vector3Stamped>("median");
  }

  /// After a time without subscribers the first frame has no flow from the last one before.
  void listen(bool listens)
  {
    if (!listens) finder_->reset();
  }

  void process(const sensor_msgs::ImageConstPtr& message, const cv::Mat& image, LazyOutputs& outputs)
  {
    const std_msgs::Header& header = message->header;
    const cv::Mat flow = finder_->update(header.stamp.toSec(), image, message->encoding);
    if (flow.empty()) return;
    if (outputs.isWanted("flow"))
      outputs.publishImage("flow", header,
                           [&](cv::Mat& out)
                           {
                             flow.copyTo(out);
                             return "32FC2";
                           });
    const double interval = finder_->interval();
    if (interval > 0.0)  // else there is no speed
    {
      if (outputs.isWanted("mean")) outputs.publish("mean", speed(header, meanFlow(flow) / interval));
      if (outputs.isWanted("median")) outputs.publish("median", speed(header, medianFlow(flow) / interval));
    }
    if (outputs.isWanted("processed_image"))
      outputs.publishImage("processed_image", header,
                           [&](cv::Mat& out)
                           {
                             draw(image, message->encoding, flow, out);
                             return "bgr8";
                           });
  }

private:
  static geometry_msgs::Vector3StampedPtr speed(const std_msgs::Header& header, const cv::Point2d& pixels)
  {
    const auto message = boost::make_shared<geometry_msgs::Vector3Stamped>();
    message->header = header;
    message->vector.x = pixels.x;
    message->vector.y = pixels.y;
    return message;
  }

  void draw(const cv::Mat& image, const std::string& encoding, const cv::Mat& flow, cv::Mat& out) const
  {
    if (drawing_.draw == "wheel")
    {
      flowToColors(flow, drawing_.max_speed, out);
      return;
    }
    cv::Mat bgr;
    toBgr(image, encoding, bgr);
    bgr.copyTo(out);  // of bgr8 they are the input's own pixels
    drawFlowArrows(out, flow, drawing_.arrow_spacing, drawing_.arrow_scale);
  }

  std::unique_ptr<DenseFlow> finder_;
  DenseFlowParams params_;
  FlowDrawingParams drawing_;
};

using DenseFlowNodelet = ImageNodelet<DenseFlowConfig, DenseFlowWork>;

}  // namespace

boost::shared_ptr<nodelet::Nodelet> makeDenseFlow()
{
  return boost::make_shared<DenseFlowNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::DenseFlowNodelet, nodelet::Nodelet)
