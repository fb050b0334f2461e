#include <gtest/gtest.h>
#include <image_transport/image_transport.h>
#include <robot_vision/ShmImage.h>
#include <ros/ros.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "ros/images/shared_image.hpp"
#include "ros/images/shared_topic.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"

using namespace robot_vision;

namespace
{

using Addresses = Receiver<ShmImage>;

constexpr std::size_t kPixels = 64 * 48;

sensor_msgs::Image makeImage(std::uint8_t gray)
{
  sensor_msgs::Image image;
  image.encoding = "mono8";
  image.width = image.step = 64;
  image.height = 48;
  image.data.assign(kPixels, gray);
  image.header.stamp.sec = gray;
  return image;
}

/// Makes and drops images in the topic's memory, as many as it takes to use all of it that nobody holds.
void useMemory(const std::string& topic)
{
  const std::shared_ptr<SharedTopic> shared = SharedTopic::of(topic);
  for (int i = 0; i < 20; ++i)
  {
    const sensor_msgs::ImagePtr image = shared->make(kPixels);
    ASSERT_TRUE(image);
    std::fill(image->data.begin(), image->data.end(), 255);
    SharedTopic::Published published;
    ASSERT_TRUE(shared->publish(*image, image->data.data(), image->data.size(), published));
  }
}

std::vector<std::uint8_t> pixelsOf(const ShmImage& message)
{
  SharedImages images("/none");
  return images.hold(message)->data;
}

TEST(ShmPublisher, aLatchedImageStaysForThoseWhoComeLater)
{
  image_transport::ImageTransport transports{ros::NodeHandle()};
  const image_transport::Publisher publisher = transports.advertise("/latched", 1, /*latch=*/true);
  const Addresses early("/latched/shm");
  ASSERT_TRUE(waitFor([&] { return SharedTopic::of("/latched")->isRead(); }));
  for (const std::uint8_t gray : {1, 2, 3})
  {
    publisher.publish(makeImage(gray));
    ASSERT_TRUE(waitFor([&] { return early.last() && early.last()->header.stamp.sec == gray; }));
    useMemory("/latched");
    Addresses late("/latched/shm");
    const Addresses::Pointer latched = late.wait();
    ASSERT_TRUE(latched);
    EXPECT_EQ(latched->header.stamp.sec, gray);
    EXPECT_EQ(pixelsOf(*latched), makeImage(gray).data);
  }
}

/// All messages of a topic.
class Collector
{
public:
  explicit Collector(const std::string& topic)
    : subscriber_(ros::NodeHandle().subscribe<ShmImage>(topic, 100, [this](const ShmImageConstPtr& got) { put(got); }))
  {
  }
  ~Collector() { subscriber_.shutdown(); }

  /// The message with this stamp.
  ShmImageConstPtr wait(std::uint32_t seconds) const
  {
    EXPECT_TRUE(waitFor([&] { return find(seconds) != nullptr; })) << seconds;
    return find(seconds);
  }

private:
  void put(const ShmImageConstPtr& message)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.push_back(message);
  }

  ShmImageConstPtr find(std::uint32_t seconds) const
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const ShmImageConstPtr& message : messages_)
      if (message->header.stamp.sec == seconds) return message;
    return nullptr;
  }

  mutable std::mutex mutex_;
  std::vector<ShmImageConstPtr> messages_;
  ros::Subscriber subscriber_;
};

TEST(ShmPublisher, anImageForOneSubscriberAloneTakesNoLatchedOnesPlace)
{
  image_transport::ImageTransport transports{ros::NodeHandle()};
  const auto greet = [](const image_transport::SingleSubscriberPublisher& subscriber)
  { subscriber.publish(makeImage(9)); };
  const image_transport::Publisher publisher = transports.advertise(
      "/greeting", 1, greet, image_transport::SubscriberStatusCallback(), ros::VoidPtr(), /*latch=*/true);
  {
    const Collector first("/greeting/shm");
    first.wait(9);
    publisher.publish(makeImage(1));
    first.wait(1);
  }
  {
    const Collector second("/greeting/shm");
    second.wait(9);
    useMemory("/greeting");
  }
  const Collector third("/greeting/shm");
  const ShmImageConstPtr latched = third.wait(1);
  ASSERT_TRUE(latched);
  EXPECT_EQ(pixelsOf(*latched), makeImage(1).data);
}

TEST(ShmPublisher, aPartOfAnImageInSharedMemoryIsThatPart)
{
  const Addresses reader("/part/shm");
  image_transport::ImageTransport transports{ros::NodeHandle()};
  const image_transport::Publisher publisher = transports.advertise("/part", 1);
  const std::shared_ptr<SharedTopic> shared = SharedTopic::of("/part");
  ASSERT_TRUE(waitFor([&] { return shared->isRead(); }));
  const sensor_msgs::ImagePtr whole = shared->make(kPixels);
  ASSERT_TRUE(whole);
  for (std::size_t i = 0; i < kPixels; ++i)
    whole->data[i] = static_cast<std::uint8_t>(i % 251);
  sensor_msgs::Image part = makeImage(0);
  part.height = 10;
  SharedTopic::Published published;
  ASSERT_TRUE(shared->publish(part, whole->data.data(), 640, published));
  EXPECT_EQ(pixelsOf(published.message), std::vector<std::uint8_t>(whole->data.begin(), whole->data.begin() + 640));
}

struct Probe
{
  void onImage(const sensor_msgs::ImageConstPtr&) {}
};

TEST(ShmSubscriber, keepsTheObjectOfItsCallbackNotAlive)
{
  image_transport::ImageTransport transports{ros::NodeHandle()};
  auto probe = boost::make_shared<Probe>();
  const boost::weak_ptr<Probe> tracked = probe;
  const image_transport::Subscriber subscriber =
      transports.subscribe("/tracked", 1, &Probe::onImage, probe, image_transport::TransportHints("shm"));
  probe.reset();
  EXPECT_TRUE(waitFor([&] { return tracked.expired(); }));  // a review may hold it for a moment
  EXPECT_EQ(subscriber.getNumPublishers(), 0U);
}

}  // namespace

int main(int argc, char** argv)
{
  return runTests(argc, argv, "test_shm_latching");
}
