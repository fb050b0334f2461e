#include "pooled_image_publisher.hpp"

#include <utility>

#include "advertising_lock.hpp"

namespace robot_vision
{

PooledImagePublisher::PooledImagePublisher(const std::string& topic, image_transport::ImageTransport& it,
                                           const std::function<void()>& on_connection, CallbackGate::Between between)
  : between_(std::move(between))
{
  const auto on_image = [on_connection](const image_transport::SingleSubscriberPublisher&) { on_connection(); };
  const AdvertisingLock advertising;
  publisher_ = it.advertise(topic, 1, on_image, on_image);
  shared_topic_ = SharedTopic::of(publisher_.getTopic());
  pool_.addTopic(shared_topic_);
}

void PooledImagePublisher::close()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!publisher_) return;  // so that the end of what is closed waits for nobody
  }
  const AdvertisingLock advertising;
  image_transport::Publisher ending;  // with the settings of the transports, which have topics of their own
  {
    const std::lock_guard<std::mutex> lock(mutex_);  // which goes before they do, as their end waits for callbacks
    std::swap(ending, publisher_);
  }
  // The transports are told of subscribers that come and go, also while they are destroyed.
  between_([&ending] { ending.shutdown(); });
}

std::uint32_t PooledImagePublisher::subscribers() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return publisher_.getNumSubscribers();
}

void PooledImagePublisher::publish(const cv::Mat& pixels, const std::string& encoding, const std_msgs::Header& header)
{
  requireEncoding(pixels, encoding);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (publisher_.getNumSubscribers() == 0) return;
  const sensor_msgs::ImagePtr message = pool_.take(pixels.size(), encoding);
  message->header = header;
  message->header.seq = ++published_;
  cv::Mat target = writablePixels(*message);
  pixels.copyTo(target);
  publisher_.publish(sensor_msgs::ImageConstPtr(message));
}

}  // namespace robot_vision
