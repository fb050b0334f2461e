#include <robot_vision/TheoraPublisherConfig.h>

#include <chrono>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>

#include "decode_backlog.hpp"
#include "robot_vision/codecs/theora.hpp"
#include "robot_vision/image/encoding.hpp"
#include "ros/params/fields.hpp"
#include "theora_packet.hpp"
#include "transport_publisher.hpp"
#include "transport_subscriber.hpp"

namespace robot_vision
{
namespace
{

TheoraParams toParams(const TheoraPublisherConfig& config)
{
  auto params = filled<TheoraParams>(config);
  params.constant_quality = config.optimize_for == TheoraPublisher_Quality;
  validate(params);
  return params;
}

TheoraPacketMessage toMessage(const TheoraPacket& packet, const std_msgs::Header& header)
{
  return {header, packet.data, packet.begins_stream, packet.ends_stream, packet.granule_position, packet.number};
}

TheoraPacket toPacket(const TheoraPacketMessage& message)
{
  return {message.data, message.b_o_s != 0, message.e_o_s != 0, message.granulepos, message.packetno};
}

/// Whether the packet is a frame, but no whole image (Theora specification, 6.1 and 7.1).
bool isChange(const TheoraPacket& packet)
{
  return packet.data.empty() || (packet.data[0] & 0xC0) == 0x40;
}

}  // namespace

/// Publishes image_transport's "theora". A new subscriber gets the headers at once, and the next image is a keyframe
/// for all subscribers. Of depths, which a video could not hold, it publishes nothing.
class TheoraPublisher : public TransportPublisher<TheoraPacketMessage, TheoraPublisherConfig, TheoraParams>
{
public:
  TheoraPublisher() : TransportPublisher(toParams) {}
  ~TheoraPublisher() override { TheoraPublisher::shutdown(); }

  std::string getTransportName() const override { return "theora"; }

private:
  void advertiseImpl(ros::NodeHandle& nh, const std::string& base_topic, std::uint32_t queue_size,
                     const image_transport::SubscriberStatusCallback& on_connect,
                     const image_transport::SubscriberStatusCallback& on_disconnect, const ros::VoidPtr& tracked_object,
                     bool /*latch*/) override
  {
    // Without latching: a latched frame that depends on earlier ones would show a new subscriber nothing.
    TransportPublisher::advertiseImpl(nh, base_topic, queue_size + kTheoraHeaders, on_connect, on_disconnect,
                                      tracked_object,
                                      /*latch=*/false);
  }

  void connectCallback(const ros::SingleSubscriberPublisher& subscriber) override
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const TheoraPacket& header : encoder_.headers())
      subscriber.publish(toMessage(header, last_));
    encoder_.requestKeyframe();
  }

  void send(const sensor_msgs::Image& message, const TheoraParams& params, const PublishFn& publish_fn) const override
  {
    if (isDepthEncoding(message.encoding)) return leaveEmpty(message.encoding + " images hold depths");
    const cv::Mat bgr = convertPixels(message, "bgr8");
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!equalFields(params, params_)) encoder_ = TheoraEncoder(params);
    params_ = params;
    last_ = message.header;
    for (const TheoraPacket& packet : encoder_.encode(bgr))
      publish_fn(toMessage(packet, message.header));
  }

  mutable std::mutex mutex_;  // guards all below, because subscribers and images come in different threads
  mutable TheoraParams params_;
  mutable TheoraEncoder encoder_;
  mutable std_msgs::Header last_;
};

/// Subscribes to "theora" and gives bgr8. All frames since the last whole image are decoded, also for a node that is
/// slower than the camera and uses the newest alone, unless they come faster than they can be decoded.
/// Live parameter: `post_processing_level`, 0 to 7, softens the edges of blocks.
class TheoraSubscriber : public TransportSubscriber<TheoraPacketMessage>
{
public:
  TheoraSubscriber() : TransportSubscriber(kTheoraFrames + kTheoraHeaders) {}

  std::string getTransportName() const override { return "theora"; }

private:
  sensor_msgs::ImagePtr decode(const TheoraPacketMessage& message) override
  {
    int level = 0;
    nh().getParamCached("post_processing_level", level);
    decoder_.setPostProcessing(level);
    const TheoraPacket packet = toPacket(message);
    // The decoder goes on with the next whole image.
    if (isChange(packet) && backlog_.isTooLong(waiting())) return nullptr;
    const auto begin = std::chrono::steady_clock::now();
    if (!decoder_.decode(packet, bgr_)) return nullptr;
    const sensor_msgs::ImagePtr image = makeImage(message.header,
                                                  [this](cv::Mat& pixels)
                                                  {
                                                    bgr_.copyTo(pixels);
                                                    return std::string("bgr8");
                                                  });
    image->header.seq = sequenceOf(packet);
    backlog_.decoded(std::chrono::steady_clock::now() - begin);
    return image;
  }

  /// The number of an image. roscpp has numbered all messages, of which some are headers.
  std::uint32_t sequenceOf(const TheoraPacket& frame)
  {
    // Another stream begins anew.
    const auto step = static_cast<std::uint32_t>(frame.number) - static_cast<std::uint32_t>(number_);
    sequence_ += frame.number > number_ ? step : 1;
    number_ = frame.number;
    return sequence_;
  }

  std::int64_t number_ = 0;     // of the last frame's packet
  std::uint32_t sequence_ = 0;  // of its image
  DecodeBacklog backlog_;
  TheoraDecoder decoder_;
  cv::Mat bgr_;
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::TheoraPublisher, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(robot_vision::TheoraSubscriber, image_transport::SubscriberPlugin)
