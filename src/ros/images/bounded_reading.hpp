#pragma once

#include <robot_vision/ShmImage.h>
#include <ros/advertise_service_options.h>
#include <ros/serialization.h>
#include <ros/subscribe_options.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace robot_vision
{

/// Deserializes a received message, but checks that the values of an array are there before it allocates memory for
/// them. roscpp's own stream allocates as many as the message claims: an Image of 46 bytes can take 4 GB. It also
/// computes the number of bytes in 32 bits, so that it accepts a CameraInfo that claims 2^29 distortion coefficients
/// and has none.
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

  template <class T, class Allocator>
  void next(std::vector<T, Allocator>& values)
  {
    BoundedStream ahead = *this;
    std::uint32_t count = 0;
    ahead.next(count);
    if (ros::message_traits::isSimple<T>())
    {
      if (count > ahead.getLength() / sizeof(T)) ros::serialization::throwStreamOverrun();
      ros::serialization::deserialize(*this, values);
      return;
    }
    // One by one, as no size of theirs is known: a transform takes far more memory than the byte that one may be of.
    *this = ahead;
    values.clear();
    for (; count > 0; --count)
    {
      values.emplace_back();
      next(values.back());
    }
  }
};

/// Clears a truncated message. The header of an image stays, because it tells which frame it was.
template <class Message>
auto clearContent(Message& message) -> decltype(message.data.clear())
{
  message.data.clear();
}

inline void clearContent(sensor_msgs::CameraInfo& info)
{
  info = {};
}

/// Nothing of it says where its pixels would be; the header stays, as an image's does.
inline void clearContent(ShmImage& image)
{
  const std_msgs::Header header = image.header;
  image = {};
  image.header = header;
}

inline void clearContent(tf2_msgs::TFMessage& message)
{
  message.transforms.clear();
}

/// Reads a message; if it is truncated, only what clearContent() leaves is kept.
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
    clearContent(message);
  }
}

/// Reads the messages of a subscription in this way. Truncated messages go to the callback, which refuses them like all
/// bad frames.
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

/// The options to subscribe with.
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

/// Reads the requests of a service in this way. For a truncated request roscpp answers the caller with an error.
template <class Service>
class BoundedService : public ros::ServiceCallbackHelper
{
public:
  using Callback = std::function<bool(typename Service::Request&, typename Service::Response&)>;

  explicit BoundedService(Callback callback) : callback_(std::move(callback)) {}

  bool call(ros::ServiceCallbackHelperCallParams& params) override
  {
    typename Service::Request request;
    typename Service::Response response;
    std::uint8_t* const begin = params.request.message_start;
    const std::size_t length = params.request.num_bytes - static_cast<std::size_t>(begin - params.request.buf.get());
    BoundedStream stream(begin, static_cast<std::uint32_t>(length));
    ros::serialization::deserialize(stream, request);
    const bool served = callback_(request, response);
    params.response = ros::serialization::serializeServiceResponse(served, response);
    return served;
  }

private:
  Callback callback_;
};

/// The options to advertise a service with.
template <class Service>
ros::AdvertiseServiceOptions boundedService(const std::string& name,
                                            typename BoundedService<Service>::Callback callback)
{
  namespace traits = ros::service_traits;
  ros::AdvertiseServiceOptions options;
  options.service = name;
  options.md5sum = traits::md5sum<Service>();
  options.datatype = traits::datatype<Service>();
  options.req_datatype = ros::message_traits::datatype<typename Service::Request>();
  options.res_datatype = ros::message_traits::datatype<typename Service::Response>();
  options.helper = boost::make_shared<BoundedService<Service>>(std::move(callback));
  return options;
}

}  // namespace robot_vision
