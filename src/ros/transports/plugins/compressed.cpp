#include <sensor_msgs/CompressedImage.h>

#include <pluginlib/class_list_macros.hpp>

#include "robot_vision/codecs/compressed_image.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/transports/compression.hpp"
#include "transport_publisher.hpp"
#include "transport_subscriber.hpp"

namespace robot_vision
{

/// Publishes image_transport's "compressed": JPEG or PNG, which cannot hold 32FC1.
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
    if (message.encoding == "32FC1") return leaveEmpty("32FC1 images hold depths");
    publish_fn(compressMessage(message, params));
  }
};

/// Subscribes to "compressed". Live parameters: `mode` (unchanged, gray or color) and `reduction` (1, 2, 4 or 8).
class CompressedSubscriber : public TransportSubscriber<sensor_msgs::CompressedImage>
{
public:
  std::string getTransportName() const override { return "compressed"; }

private:
  sensor_msgs::ImagePtr decode(const sensor_msgs::CompressedImage& message) override
  {
    const ColorMode mode = colorMode();
    int reduction = 1;
    nh().getParamCached("reduction", reduction);
    const auto fill = [&](cv::Mat& pixels)
    { return decompress(message.format, message.data.data(), message.data.size(), mode, reduction, pixels); };
    return makeImage(message.header, fill);
  }

  ColorMode colorMode() const
  {
    std::string mode = "unchanged";
    nh().getParamCached("mode", mode);
    require(mode == "unchanged" || mode == "gray" || mode == "color", nh().resolveName("mode"), "'" + mode + "'",
            "unchanged, gray or color");
    return mode == "gray" ? ColorMode::kGray : mode == "color" ? ColorMode::kColor : ColorMode::kUnchanged;
  }
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedPublisher, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedSubscriber, image_transport::SubscriberPlugin)
