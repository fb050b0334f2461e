#include <gtest/gtest.h>
#include <image_transport/image_transport.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "ros/transports/plugins/theora_packet.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"

using robot_vision::TheoraPacketMessage;

namespace
{

using Clock = std::chrono::steady_clock;

/// One side of the topic "video", whose callbacks run when the test calls them.
struct Side
{
  Side()
  {
    node.setCallbackQueue(&callbacks);
    transport = std::make_unique<image_transport::ImageTransport>(node);
  }

  ros::CallbackQueue callbacks;
  ros::NodeHandle node{"~"};
  std::unique_ptr<image_transport::ImageTransport> transport;
};

sensor_msgs::ImagePtr grayImage(int value = 100)
{
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = "mono8";
  image->width = image->step = 64;
  image->height = 48;
  image->data.assign(64 * 48, static_cast<std::uint8_t>(value));
  return image;
}

}  // namespace

// For a subscriber that comes while a frame is being sent, the headers of the stream, the frame, and the headers for
// the newcomer wait together in the queue.
TEST(Theora, keepsTheFirstFrameAfterAllHeaders)
{
  Side sender, receiver;
  image_transport::Publisher publisher = sender.transport->advertise("video", 1);
  int frames = 0;
  const image_transport::Subscriber subscriber = receiver.transport->subscribe(
      "video", 1, [&frames](const sensor_msgs::ImageConstPtr&) { ++frames; }, ros::VoidPtr(),
      image_transport::TransportHints("theora"));
  ASSERT_TRUE(waitFor([&publisher] { return publisher.getNumSubscribers() == 1; }));
  publisher.publish(grayImage());
  waitFor(  // the messages may still be on their way
      [&]
      {
        sender.callbacks.callAvailable(ros::WallDuration(0.01));  // tells the publisher about its subscriber
        receiver.callbacks.callAvailable(ros::WallDuration(0.01));
        return frames > 0;
      });
  EXPECT_EQ(frames, 1);
}

// A node that works while frames come gets the newest one, made of all that came before it.
TEST(Theora, givesTheNewestOfTheFramesThatWait)
{
  Side sender, receiver, counter;
  image_transport::Publisher publisher = sender.transport->advertise("clip", 1);
  std::vector<sensor_msgs::ImageConstPtr> seen;
  const image_transport::Subscriber subscriber = receiver.transport->subscribe(
      "clip", 1, [&seen](const sensor_msgs::ImageConstPtr& image) { seen.push_back(image); }, ros::VoidPtr(),
      image_transport::TransportHints("theora"));
  int frames = 0;  // that have come: the subscriber above has got each of them first
  const auto count = [&frames](const TheoraPacketMessage::ConstPtr& packet)
  {
    const bool is_header = !packet->data.empty() && (packet->data[0] & 0x80) != 0;
    frames += is_header ? 0 : 1;
  };
  const ros::Subscriber all = counter.node.subscribe<TheoraPacketMessage>("clip/theora", 1000, count);
  ASSERT_TRUE(waitFor([&publisher] { return publisher.getNumSubscribers() == 1; }));
  int sent = 0;
  const auto send = [&]
  {
    publisher.publish(grayImage(++sent));  // of two that wait to be encoded the older one would be left out
    return waitFor(
        [&]
        {
          counter.callbacks.callAvailable();
          return frames == sent;
        });
  };
  const auto has_the_newest = [&]
  {
    receiver.callbacks.callAvailable();
    return !seen.empty() && std::abs(seen.back()->data.front() - sent) <= 3;
  };
  std::vector<std::pair<int, std::uint32_t>> last;  // images of bursts: which one it is, and its number
  for (const int burst : {20, 1, 2, 100})  // with a whole image in the last one, of which the queue holds the end
  {
    for (int i = 0; i < burst; ++i)
      ASSERT_TRUE(send());
    const Clock::time_point begin = Clock::now();
    bool comes = has_the_newest();
    // Packets that it had no core for are left out, and it goes on with the next whole image.
    const bool was_starved = Clock::now() - begin > std::chrono::milliseconds(50);
    for (int i = 0; i < 64 && was_starved && !comes; ++i)
    {
      ASSERT_TRUE(send());
      comes = has_the_newest();
    }
    EXPECT_TRUE(comes) << burst;
    last.emplace_back(sent, seen.back()->header.seq);
  }
  EXPECT_LT(seen.size(), 60U);              // On a busy machine one is given now and then while others wait.
  for (const std::size_t i : {1U, 2U, 3U})  // Numbers count images, not packets.
    EXPECT_EQ(static_cast<int>(last[i].second - last[i - 1].second), last[i].first - last[i - 1].first);
}

// As from a camera that is faster than decoding.
TEST(Theora, givesImagesThoughMessagesWaitAllTheTime)
{
  Side sender, receiver, counter;
  image_transport::Publisher publisher = sender.transport->advertise("fast", 1);
  int images = 0, messages = 0, sent = 0;
  const image_transport::Subscriber subscriber = receiver.transport->subscribe(
      "fast", 1, [&images](const sensor_msgs::ImageConstPtr&) { ++images; }, ros::VoidPtr(),
      image_transport::TransportHints("theora"));
  const auto count = [&messages](const TheoraPacketMessage::ConstPtr&) { ++messages; };
  const ros::Subscriber all = counter.node.subscribe<TheoraPacketMessage>("fast/theora", 1000, count);
  ASSERT_TRUE(waitFor([&publisher] { return publisher.getNumSubscribers() == 1; }));
  const auto send = [&]
  {
    const int before = messages;
    publisher.publish(grayImage(++sent));
    EXPECT_TRUE(waitFor(
        [&]
        {
          counter.callbacks.callAvailable();
          return messages > before;
        }));
  };
  send();
  send();
  while (images == 0 && sent < 60)
  {
    send();
    receiver.callbacks.callOne(ros::WallDuration(1.0));  // one message, of which more wait than it takes
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(images, 1);
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "theora_queue", 1);
}
