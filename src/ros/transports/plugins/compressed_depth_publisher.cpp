#include <atomic>
#include <pluginlib/class_list_macros.hpp>

#include "ros/transports/compression.hpp"
#include "transport_publisher.hpp"

namespace robot_vision
{
/// image_transport's "compressedDepth". Every picture topic has it, and recorders subscribe to all there is: of
/// pictures that hold no depths it publishes nothing, and says so once.
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
    if (!isDepth(message.encoding))
    {
      if (!told_.exchange(true))
        ROS_INFO("%s stays empty: %s pictures hold no depths", getTopic().c_str(), message.encoding.c_str());
      return;
    }
    publish_fn(compressDepthMessage(message, params));
  }

  mutable std::atomic<bool> told_{false};
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedDepthPublisher, image_transport::PublisherPlugin)
