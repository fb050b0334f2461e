#include <gtest/gtest.h>
#include <image_transport/image_transport.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <boost/make_shared.hpp>

#include "support/receiver.hpp"
#include "support/run_tests.hpp"

namespace
{

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

sensor_msgs::ImagePtr grayImage()
{
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = "mono8";
  image->width = image->step = 64;
  image->height = 48;
  image->data.assign(64 * 48, 100);
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

int main(int argc, char** argv)
{
  return runTests(argc, argv, "theora_queue", 1);
}
