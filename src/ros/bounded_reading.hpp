#pragma once

#include <ros/serialization.h>
#include <ros/subscribe_options.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace robot_vision
{

/// A message as it came over the wire. roscpp's own stream makes room for as many bytes as a message claims to have
/// before it looks whether they are there: one of 46 bytes takes 4 GB.
class BoundedStream : public ros::serialization::IStream
{
public:
  using IStream::IStream;

  template <class T>
  void next(T& value)
  {
    ros::serialization::deserialize(*this, value);
  }

  template <class Allocator>
  void next(std::vector<std::uint8_t, Allocator>& bytes)
  {
    std::uint32_t count = 0;
    next(count);
    if (count > getLength()) ros::serialization::throwStreamOverrun();
    const std::uint8_t* const first = advance(count);
    bytes.assign(first, first + count);
  }
};

/// Reads a message; of one that is cut short, the data is empty.
template <class Message>
void readBounded(std::uint8_t* bytes, std::uint32_t count, Message& message)
{
  try
  {
    BoundedStream stream(bytes, count);
    ros::serialization::deserialize(stream, message);
  }
  catch (const ros::serialization::StreamOverrunException&)
  {
    message.data.clear();
  }
}

/// The same for a subscription. What is cut short goes to the callback, which refuses it as it does all bad frames.
template <class Message>
class BoundedReading : public ros::SubscriptionCallbackHelperT<const boost::shared_ptr<Message const>&>
{
  using Base = ros::SubscriptionCallbackHelperT<const boost::shared_ptr<Message const>&>;

public:
  using typename Base::Callback;
  using typename Base::CreateFunction;

  BoundedReading(const Callback& callback, const CreateFunction& create) : Base(callback, create), create_(create) {}

  ros::VoidConstPtr deserialize(const ros::SubscriptionCallbackHelperDeserializeParams& params) override
  {
    const boost::shared_ptr<Message> message = create_();
    readBounded(params.buffer, params.length, *message);
    return message;
  }

private:
  CreateFunction create_;
};

/// What to subscribe with.
template <class Message>
ros::SubscribeOptions boundedOptions(
    const std::string& topic, std::uint32_t queue_size, const typename BoundedReading<Message>::Callback& callback,
    const typename BoundedReading<Message>::CreateFunction& create = [] { return boost::make_shared<Message>(); })
{
  ros::SubscribeOptions options(topic, queue_size, ros::message_traits::md5sum<Message>(),
                                ros::message_traits::datatype<Message>());
  options.helper = boost::make_shared<BoundedReading<Message>>(callback, create);
  return options;
}

}  // namespace robot_vision
