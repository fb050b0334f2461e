#include <sensor_msgs/CompressedImage.h>

#include <pluginlib/class_list_macros.hpp>

#include "robot_vision/codecs/compressed_depth.hpp"
#include "transport_subscriber.hpp"

namespace robot_vision
{

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

PLUGINLIB_EXPORT_CLASS(robot_vision::CompressedDepthSubscriber, image_transport::SubscriberPlugin)
