#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ros/images/embedded_roscpp_node.hpp"
#include "ros/images/waiting_images.hpp"
#include "support/receiver.hpp"

using namespace robot_vision;

namespace
{

EmbeddedRoscppNode* process = nullptr;  // there is one per process

sensor_msgs::ImagePtr makeMessage(std::uint32_t seq)
{
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.seq = seq;
  message->header.stamp = ros::Time(seq + 1, 0);
  message->header.frame_id = "numbered";  // by what its pixels are
  message->encoding = "bgr8";
  message->width = 64;
  message->height = 48;
  message->step = 64 * 3 + 8;
  message->data.assign(std::size_t{message->step} * message->height, static_cast<std::uint8_t>(seq));
  return message;
}

/// A node whose thread takes images until it is told to end.
class Taker
{
public:
  Taker(const std::string& name, const std::string& topic, const std::string& encoding = "")
    : queue_(process->makeQueue(name, "/diagnostics")),
      inbox_(queue_->makeInbox({topic, "raw", name, encoding, ""}, std::make_shared<FrameStatistics>()))
  {
    inbox_->open();
    thread_ = std::thread([this] { run(); });
  }

  ~Taker()
  {
    queue_->close();
    thread_.join();
  }

  Taker(const Taker&) = delete;
  Taker& operator=(const Taker&) = delete;

  bool has(std::uint32_t seq) const { return taken_ > 0 && last_ == seq; }
  const void* pixels() const { return pixels_; }
  const void* message() const { return message_; }
  std::uint32_t publishers() const { return inbox_->publishers(); }

private:
  void run()
  {
    while (queue_->running())
    {
      const auto delivery = queue_->next(1.0);
      if (!delivery) continue;
      const ReceivedImage& image = delivery->image;
      if (image.header.frame_id == "numbered")
        EXPECT_EQ(image.pixels.image.at<cv::Vec3b>(47, 63)[0], static_cast<std::uint8_t>(image.header.seq));
      pixels_ = image.pixels.image.data;
      message_ = image.pixels.owner.get();
      last_ = image.header.seq;
      ++taken_;
    }
  }

  std::atomic<int> taken_{0};
  std::atomic<std::uint32_t> last_{0};
  std::atomic<const void*> pixels_{nullptr};
  std::atomic<const void*> message_{nullptr};
  std::shared_ptr<NodeQueue> queue_;
  std::shared_ptr<LatestImageSubscriber> inbox_;
  std::thread thread_;
};

/// A callback that stands still until it is told to go on.
class Standstill
{
public:
  void call()
  {
    begun_ = true;
    waitFor([this] { return goes_on_.load(); });
    ended_ = true;
  }

  /// Whether `end` waits for the callback, which has begun or is about to.
  void expectWaitedFor(const std::function<void()>& end)
  {
    ASSERT_TRUE(waitFor([this] { return begun_.load(); }));
    std::thread ending(
        [&]
        {
          end();
          EXPECT_TRUE(ended_);
        });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // in which it ends if it does not wait
    goes_on_ = true;
    ending.join();
  }

private:
  std::atomic<bool> begun_{false}, goes_on_{false}, ended_{false};
};

/// A queue whose callbacks have all been taken out to be called.
struct TakenQueue : ros::CallbackQueueInterface
{
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t /*owner*/) override
  {
    callbacks.push_back(callback);
  }
  void removeByID(std::uint64_t owner) override { removed.push_back(owner); }

  std::vector<ros::CallbackInterfacePtr> callbacks;
  std::vector<std::uint64_t> removed;
};

/// A queue that does something else when a callback comes, in the thread that it comes from.
struct ActingQueue : ros::CallbackQueueInterface
{
  explicit ActingQueue(std::function<void()> what) : act(std::move(what)) {}
  void addCallback(const ros::CallbackInterfacePtr& /*callback*/, std::uint64_t /*owner*/) override { act(); }
  void removeByID(std::uint64_t /*owner*/) override {}

  const std::function<void()> act;
};

/// Counts what comes.
struct CountingListener : ProcessImages::Listener
{
  void onComing() override { ++coming; }
  void onFrame(const std::shared_ptr<ProcessFrame>& /*frame*/) override { ++frames; }

  std::atomic<int> coming{0};
  std::atomic<int> frames{0};
};

class Counting : public ros::CallbackInterface
{
public:
  explicit Counting(int& calls) : calls_(calls) {}
  CallResult call() override
  {
    ++calls_;
    return Success;
  }

private:
  int& calls_;
};

}  // namespace

TEST(NodeQueue, nodesOfAProcessGetTheBufferThatWasPublishedInIt)
{
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("/camera", 1);
  Taker first("/first", "/camera");
  Taker second("/second", "/camera", "bgr8");  // which it has already
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() == 1 && first.publishers() == 1; }));
  for (std::uint32_t seq = 1; seq < 50; ++seq)
  {
    const sensor_msgs::ImageConstPtr message = makeMessage(seq);
    publisher.publish(message);
    ASSERT_TRUE(waitFor([&] { return first.has(seq) && second.has(seq); }));
    EXPECT_EQ(first.pixels(), message->data.data());
    EXPECT_EQ(second.pixels(), message->data.data());
    EXPECT_EQ(first.message(), message.get());
  }
}

TEST(NodeQueue, nodesComeAndGoWhileFramesFlow)
{
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("/stream", 1);
  std::atomic<bool> ends{false};
  std::atomic<std::uint32_t> seq{0};
  std::thread sender(
      [&]
      {
        while (!ends)
        {
          publisher.publish(makeMessage(++seq % 200));
          std::this_thread::yield();
        }
      });
  Taker stays("/stays", "/stream", "rgb8");
  std::vector<std::thread> others;
  for (int i = 0; i < 3; ++i)
    others.emplace_back(
        [i]
        {
          for (int turn = 0; turn < 100; ++turn)
          {
            const Taker taker("/goes_" + std::to_string(i), "/stream", i == 0 ? "" : "rgb8");
            if (turn % 10 == 0) EXPECT_TRUE(waitFor([&] { return taker.pixels() != nullptr; }));
          }
        });
  for (std::thread& other : others)
    other.join();
  const std::uint32_t before = seq;
  EXPECT_TRUE(waitFor([&] { return seq > before + 5; }));
  ends = true;
  sender.join();
  publisher.publish(makeMessage(255));
  EXPECT_TRUE(waitFor([&] { return stays.has(255); }));
}

TEST(LatestImageSubscriber, whatIsClosedBeforeItIsAddedGetsNoFrames)
{
  const auto subscriptions = std::make_shared<ProcessSubscriptions>();
  const auto images = subscriptions->take("/closing/image", "raw");
  const auto waker = std::make_shared<Waker>();
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("/closing/image", 1);
  LatestImageSubscriber inbox({"/closing/image", "raw", "~", "", "/closing/camera_info"},
                              {ros::NodeHandle(), subscriptions, waker}, std::make_shared<FrameStatistics>());
  ActingQueue closes([&inbox] { inbox.end(); });  // while it subscribes to the camera_info that is published here
  ros::NodeHandle nh;
  nh.setCallbackQueue(&closes);
  const ros::SubscriberStatusCallback on_connection = [](const ros::SingleSubscriberPublisher&) {};
  const ros::Publisher infos = nh.advertise<sensor_msgs::CameraInfo>("/closing/camera_info", 1, on_connection);
  inbox.open();
  CountingListener other;  // which is told after those that were added before
  images->add(other, "~");
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() == 1; }));
  publisher.publish(makeMessage(1));
  EXPECT_TRUE(waitFor([&] { return other.coming > 0; }));
  EXPECT_FALSE(waker->waitUntil(Waker::Clock::now()));
  images->remove(other);
}

TEST(LatestImageSubscriber, fewLargeImagesWaitForTheirCameraInfo)
{
  const auto subscriptions = std::make_shared<ProcessSubscriptions>();
  const auto images = subscriptions->take("/large/image", "raw");
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::Image>("/large/image", 1);
  LatestImageSubscriber inbox({"/large/image", "raw", "~", "", "/large/camera_info"},
                              {ros::NodeHandle(), subscriptions, std::make_shared<Waker>()},
                              std::make_shared<FrameStatistics>());
  inbox.open();
  CountingListener other;
  images->add(other, "~");
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() == 1; }));
  std::vector<boost::weak_ptr<sensor_msgs::Image>> sent;
  for (int count = 1; count <= 2; ++count)
  {
    auto message = makeMessage(0);
    message->data.resize(kMaxWaitingBytes / 2 + 1);
    sent.push_back(message);
    publisher.publish(std::move(message));
    ASSERT_TRUE(waitFor(
        [&]
        {
          inbox.take();
          return other.frames == count;
        }));
  }
  EXPECT_TRUE(sent[0].expired());
  EXPECT_FALSE(sent[1].expired());
  images->remove(other);
}

TEST(NodeQueue, itsEndWaitsForAReport)
{
  ros::param::set("/reports/diagnostic_period", 0.01);
  const auto queue = process->makeQueue("/reports", "/diagnostics");
  Standstill report;
  const auto count = [&report]
  {
    report.call();
    return std::uint64_t{0};
  };
  queue->makeStatistics()->countUnshared(count);
  report.expectWaitedFor([&queue] { queue->close(); });
}

TEST(CallbackGate, whatWasRemovedIsNotCalledByAQueueThatHasTakenItOut)
{
  TakenQueue taken;
  ros::NodeHandle nh;
  nh.setCallbackQueue(&taken);
  CallbackGate gate;
  gate.guard(nh);
  int stays = 0, goes = 0;
  nh.getCallbackQueue()->addCallback(boost::make_shared<Counting>(stays), 1);
  nh.getCallbackQueue()->addCallback(boost::make_shared<Counting>(goes), 2);
  for (const auto& callback : taken.callbacks)
    callback->call();
  EXPECT_EQ(stays, 1);
  EXPECT_EQ(goes, 1);

  gate.between()([&nh] { nh.getCallbackQueue()->removeByID(2); });
  for (const auto& callback : taken.callbacks)
    callback->call();
  EXPECT_EQ(stays, 2);
  EXPECT_EQ(goes, 1);
  EXPECT_EQ(taken.removed, std::vector<std::uint64_t>{2});

  nh.getCallbackQueue()->addCallback(boost::make_shared<Counting>(goes), 2);  // another one of the same number
  taken.callbacks.back()->call();
  EXPECT_EQ(goes, 2);
}

TEST(PooledImagePublisher, itsEndWaitsForAConnection)
{
  CallbackGate gate;
  ros::NodeHandle nh;
  gate.guard(nh);
  image_transport::ImageTransport it(nh);
  Standstill connection;
  PooledImagePublisher publisher(
      "/watched", it, [&connection] { connection.call(); }, gate.between());
  const Receiver<sensor_msgs::Image> reader("/watched");
  connection.expectWaitedFor([&publisher] { publisher.close(); });
}

TEST(PooledImagePublisher, itsEndIsSafeFromSubscribersThatLeave)
{
  const auto queue = process->makeQueue("/ending", "/diagnostics");
  for (int turn = 0; turn < 40; ++turn)
  {
    auto publisher = queue->makeOutbox("/ending/image");
    auto reader = std::make_unique<Receiver<sensor_msgs::Image>>("/ending/image");
    ASSERT_TRUE(waitFor([&publisher] { return publisher->subscribers() == 1; }));
    reader.reset();
    publisher.reset();
  }
}

TEST(ProcessFrame, thoseWhoAskForTheSameGetTheSameMemory)
{
  ProcessFrame frame(makeMessage(7), ImagePool());
  std::vector<std::thread> threads;
  std::vector<const void*> seen(8);
  for (std::size_t i = 0; i < seen.size(); ++i)
    threads.emplace_back([&, i] { seen[i] = frame.pixels(i % 2 == 0 ? "mono8" : "rgb8").image.data; });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(std::set<const void*>(seen.begin(), seen.end()).size(), 2U);
  EXPECT_EQ(frame.pixels("").image.data, frame.message()->data.data());
  for (int turn = 0; turn < 2; ++turn)
    EXPECT_THROW(frame.pixels("bayer_rggb8"), std::invalid_argument);
}

/// This must be the last test, because it ends the node.
TEST(EmbeddedRoscppNode, endsWhileFramesFlowAndNodeletsAreLoaded)
{
  ros::param::set("/eye/source", "synthetic");
  ros::param::set("/eye/framerate", 200.0);
  process->nodelets()->load("/eye", "robot_vision/camera", {}, {});
  Taker taker("/taker", "/eye/image_raw", "mono16");
  Taker other("/other", "/nothing");
  const auto queue = process->makeQueue("/idle", "/diagnostics");
  const auto outbox = queue->makeOutbox("/out");
  ASSERT_TRUE(waitFor([&] { return taker.pixels() != nullptr; }));
  int calls = 0;
  TakenQueue taken;
  ros::NodeHandle nh;
  nh.setCallbackQueue(&taken);
  CallbackGate gate;
  gate.guard(nh);
  nh.getCallbackQueue()->addCallback(boost::make_shared<Counting>(calls), 1);
  process->stop();
  taken.callbacks.front()->call();
  EXPECT_EQ(calls, 0);
  EXPECT_FALSE(queue->running());
  EXPECT_FALSE(queue->next(1.0));
  EXPECT_EQ(outbox->subscribers(), 0U);
  EXPECT_THROW(queue->makeOutbox("/late"), std::runtime_error);
  EXPECT_THROW(process->makeQueue("/late", "/diagnostics"), std::runtime_error);
  EXPECT_THROW(process->nodelets(), std::runtime_error);
}

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  EmbeddedRoscppNode node("/test_images", {}, "/test", "");
  process = &node;
  return RUN_ALL_TESTS();
}
