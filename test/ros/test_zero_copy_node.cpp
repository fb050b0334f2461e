#include <gtest/gtest.h>
#include <image_transport/image_transport.h>
#include <robot_vision/BrightnessConfig.h>
#include <ros/ros.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <functional>
#include <future>
#include <opencv2/core.hpp>

#include "nodelets/factories.hpp"
#include "robot_vision/edges/edges.hpp"
#include "robot_vision/filters/brightness.hpp"
#include "robot_vision/image/encoding.hpp"
#include "ros/images/filter_nodelet.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/lazy_image_input.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"

using namespace robot_vision;

namespace
{

using Images = Receiver<sensor_msgs::Image>;

std::vector<std::string> messageEncodings()
{
  std::vector<std::string> names = encodings();
  names.erase(std::remove_if(names.begin(), names.end(), [](const auto& name) { return !isMessageEncoding(name); }),
              names.end());
  return names;
}

/// Noise in padded rows, so that a copy would be noticed.
sensor_msgs::ImagePtr makeMessage(const std::string& encoding)
{
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->encoding = encoding;
  message->width = 64;
  message->height = 48;
  message->step = 64 * 8 + 16;
  message->data.resize(std::size_t{message->step} * message->height);
  cv::Mat bytes(1, static_cast<int>(message->data.size()), CV_8UC1, message->data.data());
  cv::RNG(7).fill(bytes, cv::RNG::UNIFORM, 0, 256);
  message->header.stamp = ros::Time::now();
  message->header.frame_id = encoding + "_frame";
  return message;
}

/// An input that remembers the address of its images.
struct Probe
{
  explicit Probe(const std::string& name)
    : input(
          ros::NodeHandle(), ros::NodeHandle(name), name,
          [this](const sensor_msgs::ImageConstPtr&, const cv::Mat& image) { seen = image.data; }, [] { return true; })
  {
    input.start();
  }

  std::atomic<const void*> seen{nullptr};
  LazyImageInput input;
};

std::promise<void> slow_end;
std::atomic<bool> slow_begun{false};
std::atomic<bool> slow_ended{false};

/// Works on a frame until it is told to end.
struct SlowFilter
{
  explicit SlowFilter(const BrightnessParams&) {}

  static std::string outputEncoding(const std::string& encoding) { return encoding; }

  void apply(const cv::Mat& image, const std::string&, cv::Mat& out) const
  {
    static const std::shared_future<void> end = slow_end.get_future().share();
    if (!slow_begun.exchange(true)) end.wait();
    image.copyTo(out);
    slow_ended = true;
  }
};

struct SlowNodelet : FilterNodelet<BrightnessConfig, BrightnessParams, SlowFilter>
{
};

boost::shared_ptr<nodelet::Nodelet> load(const boost::shared_ptr<nodelet::Nodelet>& nodelet, const std::string& name)
{
  nodelet->init(name, {}, {});
  return nodelet;
}

}  // namespace

TEST(ZeroCopy, twoNodesOfAProcessGetThePublishedBuffer)
{
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("image", 1);
  Probe first("/first_probe");
  Probe second("/second_probe");
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  for (const std::string& encoding : messageEncodings())
  {
    const sensor_msgs::ImageConstPtr message = makeMessage(encoding);
    first.seen = second.seen = nullptr;  // the new message may have the memory of the last one
    publisher.publish(message);
    const void* buffer = message->data.data();
    EXPECT_TRUE(waitFor([&] { return first.seen == buffer && second.seen == buffer; })) << encoding;
  }
}

TEST(ZeroCopy, nodeletsDoNotChangeTheirInputAndGiveTheCoresResults)
{
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("image", 1);
  const auto brightness = load(makeBrightness(), "/brightness");
  const auto edge_detector = load(makeEdgeDetector(), "/edge_detector");
  const Images brighter("/brightness/processed_image");
  const Images edges("/edge_detector/processed_image");
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  for (const std::string& encoding : messageEncodings())
  {
    const sensor_msgs::ImageConstPtr message = makeMessage(encoding);
    const std::vector<std::uint8_t> before = message->data;
    const auto arrived = [&](const Images& images)
    { return images.last() && images.last()->header.frame_id == message->header.frame_id; };
    // The nodelets subscribe one by one, so the first messages may reach only one of them.
    ASSERT_TRUE(waitFor(
        [&]
        {
          if (!arrived(brighter) || !arrived(edges)) publisher.publish(message);
          return arrived(brighter) && arrived(edges);
        }))
        << encoding;
    EXPECT_EQ(message->data, before) << encoding;

    cv::Mat expected;
    Brightness().apply(viewPixels(*message), encoding, expected);
    EXPECT_EQ(brighter.last()->encoding, Brightness::outputEncoding(encoding));
    EXPECT_EQ(cv::norm(viewPixels(*brighter.last()), expected, cv::NORM_INF), 0.0) << encoding;
    EXPECT_EQ(brighter.last()->header.stamp, message->header.stamp);
    EdgeDetector().apply(viewPixels(*message), encoding, expected);
    EXPECT_EQ(edges.last()->encoding, "mono8");
    EXPECT_EQ(cv::norm(viewPixels(*edges.last()), expected, cv::NORM_INF), 0.0) << encoding;
    EXPECT_EQ(edges.last()->header.stamp, message->header.stamp);
  }
}

TEST(ZeroCopy, cameraGivesAllSubscribersOneBuffer)
{
  ros::param::set("/camera/source", "synthetic");
  const auto camera = load(makeCamera({}), "/camera");
  const Images first("/camera/image_raw");
  const Images second("/camera/image_raw");
  EXPECT_TRUE(waitFor([&] { return first.last() && first.last() == second.last(); }));
}

TEST(ImagePool, reusesAMessageOnlyIfNobodyHoldsIt)
{
  ImagePool pool;
  sensor_msgs::ImagePtr first = pool.take({64, 48}, "bgr8");
  const void* memory = first->data.data();
  const sensor_msgs::ImagePtr second = pool.take({64, 48}, "bgr8");
  EXPECT_NE(second, first);
  first.reset();
  EXPECT_EQ(pool.take({64, 48}, "bgr8")->data.data(), memory);
}

/// This must be the last test, because it shuts roscpp down. After that, roscpp waits for no callback.
TEST(Teardown, aNodeletWaitsForItsFrameAfterTheShutdownOfRoscpp)
{
  ros::param::set("/slow/always_subscribe", true);
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("image", 1);
  boost::shared_ptr<nodelet::Nodelet> slow = load(boost::make_shared<SlowNodelet>(), "/slow");
  ASSERT_TRUE(waitFor(
      [&]
      {
        publisher.publish(makeMessage("mono8"));
        return slow_begun.load();
      }));
  ros::shutdown();
  auto ended_before = std::async(std::launch::async,
                                 [&slow]
                                 {
                                   slow.reset();
                                   return slow_ended.load();
                                 });
  EXPECT_EQ(ended_before.wait_for(std::chrono::milliseconds(200)), std::future_status::timeout);
  slow_end.set_value();
  EXPECT_TRUE(ended_before.get());
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "test_zero_copy");
}
