#include <pluginlib/class_list_macros.hpp>

#include "robot_vision/codecs/theora.hpp"
#include "theora_packet.hpp"
#include "transport_subscriber.hpp"

namespace robot_vision
{
namespace
{

TheoraPacket toPacket(const TheoraPacketMessage& message)
{
  return {message.data, message.b_o_s != 0, message.e_o_s != 0, message.granulepos, message.packetno};
}

}  // namespace

/// Subscribes to "theora" and gives bgr8. Live parameter: `post_processing_level`, 0 to 7, softens the edges of blocks.
class TheoraSubscriber : public TransportSubscriber<TheoraPacketMessage>
{
public:
  TheoraSubscriber() : TransportSubscriber(kTheoraHeaders) {}

  std::string getTransportName() const override { return "theora"; }

private:
  sensor_msgs::ImagePtr decode(const TheoraPacketMessage& message) override
  {
    int level = 0;
    nh().getParamCached("post_processing_level", level);
    decoder_.setPostProcessing(level);
    if (!decoder_.decode(toPacket(message), bgr_)) return nullptr;
    return makeImage(message.header,
                     [this](cv::Mat& pixels)
                     {
                       bgr_.copyTo(pixels);
                       return std::string("bgr8");
                     });
  }

  TheoraDecoder decoder_;
  cv::Mat bgr_;
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::TheoraSubscriber, image_transport::SubscriberPlugin)
