#include <image_transport/simple_subscriber_plugin.h>

#include <pluginlib/class_list_macros.hpp>

#include "robot_vision/theora.hpp"
#include "ros/image_message.hpp"
#include "ros/throttle.hpp"
#include "theora_packet.hpp"

namespace robot_vision
{
namespace
{

TheoraPacket toPacket(const TheoraPacketMessage& message)
{
  TheoraPacket packet;
  packet.data = message.data;
  packet.begins_stream = message.b_o_s != 0;
  packet.ends_stream = message.e_o_s != 0;
  packet.granule_position = message.granulepos;
  packet.number = message.packetno;
  return packet;
}

}  // namespace

/// The other end of "theora": bgr8. Parameter, live: `post_processing_level`, 0 to 7, softens the edges of blocks.
class TheoraSubscriber : public image_transport::SimpleSubscriberPlugin<TheoraPacketMessage>
{
public:
  std::string getTransportName() const override { return "theora"; }

protected:
  void subscribeImpl(ros::NodeHandle& nh, const std::string& base_topic, std::uint32_t queue_size,
                     const Callback& callback, const ros::VoidPtr& tracked_object,
                     const image_transport::TransportHints& transport_hints) override
  {
    SimpleSubscriberPlugin::subscribeImpl(nh, base_topic, queue_size + kTheoraHeaders, callback, tracked_object,
                                          transport_hints);
  }

  void internalCallback(const TheoraPacketMessage::ConstPtr& message, const Callback& user_cb) override
  {
    sensor_msgs::ImagePtr image;
    try
    {
      int level = 0;
      nh().getParamCached("post_processing_level", level);
      decoder_.setPostProcessing(level);
      if (!decoder_.decode(toPacket(*message), picture_)) return;
      image = pictures_.make(
          [this](cv::Mat& pixels)
          {
            picture_.copyTo(pixels);
            return std::string("bgr8");
          });
      image->header = message->header;
    }
    catch (const std::exception& e)
    {
      if (refused_.due()) ROS_ERROR("refused a packet on %s: %s", getTopic().c_str(), e.what());
      return;
    }
    user_cb(image);
  }

private:
  TheoraDecoder decoder_;
  cv::Mat picture_;
  ImageMaker pictures_;
  Throttle refused_;
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::TheoraSubscriber, image_transport::SubscriberPlugin)
