#include <pluginlib/class_list_macros.hpp>

#include "ros/transports/compression.hpp"
#include "transport_publisher.hpp"

namespace robot_vision
{

/// Publishes image_transport's "compressed": JPEG or PNG.
class CompressedPublisher
  : public TransportPublisher<sensor_msgs::CompressedImage, CompressedPublisherConfig, CompressionParams>
{
public:
  CompressedPublisher() : TransportPublisher(toCompressionParams) {}
  ~CompressedPublisher() override { CompressedPublisher::shutdown(); }

  std::string getTransportName() const override { return "compressed"; }

private:
  void send(const sensor_msgs::Image& message, const CompressionParams& params,
            const PublishFn& publish_fn) const override
  {
    publish_fn(compressMessage(message, params));
  }
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedPublisher, image_transport::PublisherPlugin)
