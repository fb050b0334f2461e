#pragma once

#include <ros/advertise_service_options.h>
#include <ros/serialization.h>
#include <ros/subscribe_options.h>
#include <sensor_msgs/CameraInfo.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace robot_vision
{

/// A message as it came over the wire. roscpp's own stream makes room for as many values as a message claims to have
/// before it looks whether they are there: an Image of 46 bytes takes 4 GB. It counts their bytes in 32 bits, too: it
/// takes a CameraInfo that claims 2^29 distortion coefficients and has none.
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
    const std::size_t smallest = ros::message_traits::isSimple<T>() ? sizeof(T) : 1;
    if (count > ahead.getLength() / smallest) ros::serialization::throwStreamOverrun();
    ros::serialization::deserialize(*this, values);
  }
};

/// Of a frame that is cut short the header stays, which tells whose it was, and no data.
template <class Message>
auto forgetContent(Message& message) -> decltype(message.data.clear())
{
  message.data.clear();
}

inline void forgetContent(sensor_msgs::CameraInfo& info)
{
  info = {};
}

/// Reads a message; of one that is cut short nothing is left but what forgetContent() leaves.
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
    forgetContent(message);
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

/// The same for a service: roscpp tells who calls it with a request that is cut short that it was not taken.
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

/// What to advertise a service with.
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
