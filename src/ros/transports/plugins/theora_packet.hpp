#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <vector>

namespace robot_vision
{

/// The largest number of frames from one whole image to the next. One that is lost is missing to all behind it.
constexpr std::uint32_t kTheoraFrames = 64;

/// The number of header packets that may come together with a frame: three at the start of a stream, and three for a
/// new subscriber. The two groups come in any order, so that the second one may come after the first frame.
constexpr std::uint32_t kTheoraHeaders = 6;

/// The message theora_image_transport/Packet, for systems without that package: its name and serialized form are the
/// same.
struct TheoraPacketMessage
{
  using Ptr = boost::shared_ptr<TheoraPacketMessage>;
  using ConstPtr = boost::shared_ptr<const TheoraPacketMessage>;

  std_msgs::Header header;
  std::vector<std::uint8_t> data;
  std::int32_t b_o_s = 0;
  std::int32_t e_o_s = 0;
  std::int64_t granulepos = 0;
  std::int64_t packetno = 0;
};

}  // namespace robot_vision

namespace ros
{
namespace message_traits
{

template <>
struct IsMessage<robot_vision::TheoraPacketMessage> : TrueType
{
};

template <>
struct IsMessage<const robot_vision::TheoraPacketMessage> : TrueType
{
};

template <>
struct HasHeader<robot_vision::TheoraPacketMessage> : TrueType
{
};

template <>
struct MD5Sum<robot_vision::TheoraPacketMessage>
{
  static const char* value() { return "33ac4e14a7cff32e7e0d65f18bb410f3"; }
  static const char* value(const robot_vision::TheoraPacketMessage&) { return value(); }
};

template <>
struct DataType<robot_vision::TheoraPacketMessage>
{
  static const char* value() { return "theora_image_transport/Packet"; }
  static const char* value(const robot_vision::TheoraPacketMessage&) { return value(); }
};

template <>
struct Definition<robot_vision::TheoraPacketMessage>
{
  static const char* value()
  {
    return "std_msgs/Header header\nuint8[] data\nint32 b_o_s\nint32 e_o_s\nint64 granulepos\nint64 packetno\n"
           "\n================================================================================\n"
           "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
  }
  static const char* value(const robot_vision::TheoraPacketMessage&) { return value(); }
};

}  // namespace message_traits

namespace serialization
{

template <>
struct Serializer<robot_vision::TheoraPacketMessage>
{
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message)
  {
    stream.next(message.header);
    stream.next(message.data);
    stream.next(message.b_o_s);
    stream.next(message.e_o_s);
    stream.next(message.granulepos);
    stream.next(message.packetno);
  }

  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace serialization
}  // namespace ros
