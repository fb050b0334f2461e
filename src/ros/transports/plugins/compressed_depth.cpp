#include <sensor_msgs/CompressedImage.h>

#include <pluginlib/class_list_macros.hpp>

#include "robot_vision/codecs/compressed_depth.hpp"
#include "ros/transports/compression.hpp"
#include "transport_publisher.hpp"
#include "transport_subscriber.hpp"

namespace robot_vision
{

/// Publishes image_transport's "compressedDepth". Every image topic has this transport, but of images that hold no
/// depths it publishes nothing.
class CompressedDepthPublisher
  : public TransportPublisher<sensor_msgs::CompressedImage, CompressedDepthPublisherConfig, DepthCompressionParams>
{
public:
  CompressedDepthPublisher() : TransportPublisher(toDepthCompressionParams) {}
  ~CompressedDepthPublisher() override { CompressedDepthPublisher::shutdown(); }

  std::string getTransportName() const override { return "compressedDepth"; }

private:
  void send(const sensor_msgs::Image& message, const DepthCompressionParams& params,
            const PublishFn& publish_fn) const override
  {
    if (!isDepth(message.encoding)) return leaveEmpty(message.encoding + " images hold no depths");
    publish_fn(compressDepthMessage(message, params));
  }
};

/// Subscribes to "compressedDepth".
class CompressedDepthSubscriber : public TransportSubscriber<sensor_msgs::CompressedImage>
{
public:
  std::string getTransportName() const override { return "compressedDepth"; }

private:
  sensor_msgs::ImagePtr decode(const sensor_msgs::CompressedImage& message) override
  {
    const auto fill = [&](cv::Mat& pixels)
    { return decompressDepth(message.format, message.data.data(), message.data.size(), pixels); };
    return makeImage(message.header, fill);
  }
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedDepthPublisher, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedDepthSubscriber, image_transport::SubscriberPlugin)
