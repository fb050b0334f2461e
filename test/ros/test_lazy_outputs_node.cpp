#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <robot_vision/BrightnessConfig.h>
#include <robot_vision/FilterConfig.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_srvs/Empty.h>
#include <tf2_msgs/TFMessage.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <thread>
#include <utility>

#include "nodelets/factories.hpp"
#include "ros/depth/frame_transforms.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/image_nodelet.hpp"
#include "ros/images/lazy_image_input.hpp"
#include "ros/images/subscribing_lock.hpp"
#include "ros/images/subscription_pair.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"
#include "support/small_camera.hpp"

namespace
{

constexpr int kTurns = 200;  // of which each could show what goes wrong

std::atomic<int> large_images{0};  // that were made into messages

}  // namespace

namespace robot_vision
{

/// Takes the place of that of the library, as a program's symbols go before those of its libraries, and counts.
sensor_msgs::ImagePtr ImageMaker::make(const Fill& fill)
{
  cv::Mat pixels;
  const auto message = boost::make_shared<sensor_msgs::Image>();
  message->encoding = fill(pixels);
  message->width = static_cast<std::uint32_t>(pixels.cols);
  message->height = static_cast<std::uint32_t>(pixels.rows);
  message->step = static_cast<std::uint32_t>(pixels.cols * pixels.elemSize());
  message->data.resize(std::size_t{message->step} * message->height);
  cv::Mat target = writablePixels(*message);
  pixels.copyTo(target);
  if (message->width == SmallCamera::kWidth) ++large_images;
  return message;
}

}  // namespace robot_vision

using namespace robot_vision;
using sensor_msgs::CameraInfoConstPtr;

TEST(LazyOutputs, imagesAreNumberedOnTheirTopic)
{
  LazyOutputs outputs(ros::NodeHandle("/numbers"), [] {});
  outputs.advertiseImages("image");
  const Receiver<sensor_msgs::Image> receiver("/numbers/image");
  ASSERT_TRUE(waitFor([&] { return outputs.isWanted("image"); }));
  const auto fill = [](cv::Mat& pixels)
  {
    pixels.create(4, 6, CV_8UC1);
    return "mono8";
  };
  std_msgs::Header header;
  const auto expectNumber = [&](std::uint32_t number)
  {
    ASSERT_TRUE(waitFor([&] { return receiver.seconds().size() == number; }));
    EXPECT_EQ(receiver.last()->header.seq, number);
  };
  for (std::uint32_t number = 1; number <= 3; ++number)
  {
    header.seq += 3;  // of images of which some were left out
    outputs.publishImage("image", header, fill);
    expectNumber(number);
  }
  outputs.publishImage("image", boost::make_shared<sensor_msgs::Image>(*receiver.last()));
  expectNumber(4);
}

TEST(Filter, aStepIsMadeIntoAMessageOnlyWhileSomebodyLooksAtIt)
{
  ros::param::set("/filter/chain", "gaussian, resize");
  SmallCamera camera;
  const auto nodelet = makeFilter();
  nodelet->init("/filter", {}, {});
  const Receiver<sensor_msgs::Image> small("/filter/processed_image");
  ASSERT_TRUE(camera.showUntil([&] { return small.seconds().size() > 3; }));
  EXPECT_LT(small.last()->width, SmallCamera::kWidth);
  EXPECT_EQ(large_images, 0);

  const Receiver<sensor_msgs::Image> step("/filter/steps/gaussian");
  ASSERT_TRUE(camera.showUntil([&] { return step.last() != nullptr; }));
  EXPECT_EQ(step.last()->width, SmallCamera::kWidth);
  EXPECT_GT(large_images, 0);
}

TEST(Filter, whatCannotBeSubscribedToChangesNothing)
{
  SmallCamera camera;
  const boost::function<void(const CameraInfoConstPtr&)> ignore = [](const CameraInfoConstPtr&) {};
  const ros::Subscriber other = ros::NodeHandle().subscribe<sensor_msgs::CameraInfo>("second", 1, ignore);
  ros::param::set("/unchanged/chain", "");
  const auto nodelet = makeFilter();
  nodelet->init("/unchanged", {}, {});
  const Receiver<sensor_msgs::Image> images("/unchanged/processed_image");
  ASSERT_TRUE(camera.showUntil([&] { return images.last() != nullptr; }));
  dynamic_reconfigure::Reconfigure change;
  change.request.config.strs.resize(1);
  change.request.config.strs[0].name = "chain";
  change.request.config.strs[0].value = "resize, difference";
  change.request.config.bools.resize(1);
  change.request.config.bools[0].name = "use_second";
  change.request.config.bools[0].value = true;
  ASSERT_TRUE(ros::service::call("/unchanged/set_parameters", change));
  FilterConfig config;
  ASSERT_TRUE(config.__fromMessage__(change.response.config));
  EXPECT_EQ(config.chain, "");
  const std::size_t before = images.seconds().size();
  ASSERT_TRUE(camera.showUntil([&] { return images.seconds().size() > before + 3; }));
  EXPECT_EQ(images.last()->width, SmallCamera::kWidth);
}

namespace
{

/// Has somebody call a service of its own while it begins.
class AskedAtOnce
{
public:
  AskedAtOnce(const ros::NodeHandle& /*nh*/, ros::NodeHandle pnh) : name_(pnh.resolveName("ask"))
  {
    using Answer = boost::function<bool(std_srvs::Empty::Request&, std_srvs::Empty::Response&)>;
    service_ = pnh.advertiseService("ask", Answer([](auto&, auto&) { return true; }));
  }

  void configure(const BrightnessConfig& /*config*/) {}

  void advertise(LazyOutputs& /*outputs*/)
  {
    answered = std::async(std::launch::async,
                          [name = name_]
                          {
                            std_srvs::Empty call;
                            return ros::service::call(name, call);
                          });
    is_early = answered.wait_for(std::chrono::milliseconds(200)) == std::future_status::ready;
  }

  void process(const sensor_msgs::ImageConstPtr& /*message*/, const cv::Mat& /*image*/, LazyOutputs& /*outputs*/) {}

  static inline std::future<bool> answered;
  static inline bool is_early = true;

private:
  std::string name_;
  ros::ServiceServer service_;
};

}  // namespace

TEST(ImageNodelet, isCalledWhenItHasBegun)
{
  ImageNodelet<BrightnessConfig, AskedAtOnce> nodelet;
  nodelet.init("/asked", {}, {});
  EXPECT_FALSE(AskedAtOnce::is_early);
  EXPECT_TRUE(AskedAtOnce::answered.get());
}

namespace
{

/// Has a topic of images and one of other messages.
struct TwoResults
{
  TwoResults(const ros::NodeHandle& /*nh*/, const ros::NodeHandle& /*pnh*/) {}

  void configure(const BrightnessConfig& /*config*/) {}

  void advertise(LazyOutputs& outputs)
  {
    outputs.advertiseImages("images");
    outputs.advertise<sensor_msgs::CameraInfo>("messages");
  }

  void process(const sensor_msgs::ImageConstPtr& /*message*/, const cv::Mat& /*image*/, LazyOutputs& /*outputs*/) {}
};

/// An input that looks only when it is told to.
class ToldInput
{
public:
  ToldInput(const ros::NodeHandle& /*nh*/, const ros::NodeHandle& /*pnh*/, const std::string& /*name*/,
            const LazyImageInput::Process& /*process*/, std::function<bool()> is_wanted,
            const std::function<void(bool)>& /*on_listen*/)
    : is_wanted_(std::move(is_wanted))
  {
  }

  FrameStatistics& statistics() { return statistics_; }
  void start() {}
  void update() { is_seen_wanted = is_wanted_(); }

  static inline std::atomic<bool> is_seen_wanted{false};

private:
  std::function<bool()> is_wanted_;
  FrameStatistics statistics_;
};

}  // namespace

TEST(ImageNodelet, hasItsInputLookWhenSubscribersComeAndGo)
{
  ImageNodelet<BrightnessConfig, TwoResults, ToldInput> nodelet;
  nodelet.init("/told", {}, {});
  const auto are_seen = [](auto subscriber)
  {
    if (!waitFor([] { return ToldInput::is_seen_wanted.load(); })) return false;
    subscriber.reset();
    return waitFor([] { return !ToldInput::is_seen_wanted; });
  };
  ASSERT_TRUE(are_seen(std::make_unique<Receiver<sensor_msgs::Image>>("/told/images")));
  EXPECT_TRUE(are_seen(std::make_unique<Receiver<sensor_msgs::CameraInfo>>("/told/messages")));
}

TEST(ImageSubscription, isNoneAfterItsEnd)
{
  ros::NodeHandle nh;
  image_transport::ImageTransport it(nh);
  for (const std::string transport : {"auto", "raw", "compressed", "shm"})
  {
    const image_transport::TransportHints hints(transport, {}, nh, "none");
    ImageSubscription subscription(nh, it, "image", hints, [](const sensor_msgs::ImageConstPtr&) {});
    EXPECT_TRUE(subscription) << transport;
    subscription.shutdown();
    EXPECT_FALSE(subscription) << transport;
  }
}

TEST(ImageSubscription, isOneAfterItWasMoved)
{
  ros::NodeHandle nh;
  const ros::Publisher publisher = nh.advertise<sensor_msgs::Image>("/moved", 1);
  image_transport::ImageTransport it(nh);
  for (const std::string transport : {"auto", "raw"})
  {
    const image_transport::TransportHints hints(transport, {}, nh, "none");
    std::atomic<bool> has_come{false};
    ImageSubscription last;
    {
      ImageSubscription first(nh, it, "/moved", hints, [&](const sensor_msgs::ImageConstPtr&) { has_come = true; });
      ImageSubscription second(std::move(first));
      last = std::move(second);
    }
    const auto comes = [&]
    {
      publisher.publish(boost::make_shared<sensor_msgs::Image>());
      return has_come.load();
    };
    EXPECT_TRUE(waitFor(comes)) << transport;
    last = {};
    EXPECT_EQ(publisher.getNumSubscribers(), 0U) << transport;
  }
}

/// Has threads do something until this ends, while roscpp is asked for what the end of a subscription waits for.
class Contest
{
public:
  explicit Contest(const std::function<void()>& contend)
    : contending_([this, contend] { repeat(contend); }),
      asking_([this] { repeat([topics = ros::V_string()]() mutable { ros::this_node::getSubscribedTopics(topics); }); })
  {
  }

  ~Contest()
  {
    ends_ = true;
    contending_.join();
    asking_.join();
  }

private:
  void repeat(const std::function<void()>& work)
  {
    while (!ends_)
      work();
  }

  std::atomic<bool> ends_{false};
  std::thread contending_, asking_;
};

class EndOfAnotherOne : public ::testing::TestWithParam<const char*>
{
};

TEST_P(EndOfAnotherOne, leavesASubscriptionToTheTopic)
{
  ros::NodeHandle nh;
  const ros::Publisher publisher = nh.advertise<sensor_msgs::Image>("/contested", 1);
  const image_transport::TransportHints hints(GetParam(), {}, nh, "none");
  image_transport::ImageTransport it(nh);
  const Contest contest([&]
                        { ImageSubscription(nh, it, "/contested", hints, [](const sensor_msgs::ImageConstPtr&) {}); });
  for (int turn = 0; turn < kTurns && !HasFailure(); ++turn)
  {
    std::atomic<bool> has_come{false};
    ImageSubscription subscription(nh, it, "/contested", hints,
                                   [&](const sensor_msgs::ImageConstPtr&) { has_come = true; });
    const auto image = boost::make_shared<sensor_msgs::Image>();
    const auto comes = [&]
    {
      publisher.publish(image);
      return has_come.load();
    };
    EXPECT_TRUE(waitFor(comes)) << turn;
  }
}

INSTANTIATE_TEST_SUITE_P(ImageSubscription, EndOfAnotherOne, ::testing::Values("auto", "raw"));

TEST(FrameTransforms, comeAlthoughAnotherOneEnds)
{
  ros::NodeHandle nh;
  const ros::Publisher publisher = nh.advertise<tf2_msgs::TFMessage>("/tf_static", 1);
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.frame_id = "camera";
  message.transforms[0].child_frame_id = "lens";
  message.transforms[0].transform.rotation.w = 1.0;
  const Contest contest([&] { FrameTransforms(nh).listen(true); });
  for (int turn = 0; turn < kTurns && !HasFailure(); ++turn)
  {
    FrameTransforms transforms(nh);
    transforms.listen(true);
    const auto come = [&]
    {
      publisher.publish(message);
      return transforms.find("camera", "lens").has_value();
    };
    EXPECT_TRUE(waitFor(come)) << turn;
  }
}

TEST(SubscriptionPair, dropsNothingWithoutTheLock)
{
  SubscriptionPair pair(ros::NodeHandle(), {"/dropped"});
  const SubscribingLock subscribing;
  const auto drop = [&pair]
  {
    for (int i = 0; i < 30; ++i)
      EXPECT_FALSE(pair.drop(SubscriptionPair::Way::kRaw));
  };
  const std::future<void> dropped = std::async(std::launch::async, drop);
  EXPECT_EQ(dropped.wait_for(std::chrono::seconds(30)), std::future_status::ready);
}

TEST(LazyImageInput, aConnectionDoesNotWaitForOneThatAsksTheMaster)
{
  std::atomic<bool> wanted{true};
  std::atomic<bool> asks{false};
  std::atomic<bool> listens{false};
  std::promise<void> answer;
  const auto on_listen = [&](bool now)
  {
    asks = now;
    if (now) answer.get_future().wait();  // as long as a master that does not answer
    listens = now;
  };
  LazyImageInput input(
      ros::NodeHandle(), ros::NodeHandle("/waiting"), "/waiting",
      [](const sensor_msgs::ImageConstPtr&, const cv::Mat&) {}, [&] { return wanted.load(); }, on_listen);
  std::future<void> first = std::async(std::launch::async, [&] { input.start(); });
  EXPECT_TRUE(waitFor([&] { return asks.load(); }));
  wanted = false;
  std::future<void> second = std::async(std::launch::async, [&] { input.update(); });
  EXPECT_EQ(second.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  answer.set_value();
  first.get();
  EXPECT_FALSE(listens);  // it has looked again, and nobody wants the images any more
}

TEST(LazyImageInput, whatCannotBeSubscribedToIsToldAndTriedAgain)
{
  const ros::NodeHandle nh("/refused");
  const boost::function<void(const CameraInfoConstPtr&)> ignore = [](const CameraInfoConstPtr&) {};
  ros::Subscriber other = ros::NodeHandle(nh).subscribe<sensor_msgs::CameraInfo>("image", 1, ignore);
  std::atomic<bool> wanted{false};
  std::atomic<bool> listens{false};
  LazyImageInput input(
      nh, ros::NodeHandle(nh, "node"), "/refused/node", [](const sensor_msgs::ImageConstPtr&, const cv::Mat&) {},
      [&] { return wanted.load(); }, [&](bool now) { listens = now; });
  input.start();
  wanted = true;
  input.update();
  diagnostic_updater::DiagnosticStatusWrapper status;
  EXPECT_TRUE(waitFor(
      [&]
      {
        input.statistics().report(status);
        return status.level == diagnostic_msgs::DiagnosticStatus::ERROR;
      }));
  EXPECT_EQ(status.message.find("cannot subscribe: "), 0U) << status.message;
  other.shutdown();
  EXPECT_TRUE(waitFor([&] { return listens.load(); }));
  input.statistics().report(status);
  EXPECT_EQ(status.message, "no frames on /refused/image");
}

TEST(LazyImageInput, aStartWithoutASubscriptionFails)
{
  const ros::NodeHandle nh("/unstarted");
  const boost::function<void(const CameraInfoConstPtr&)> ignore = [](const CameraInfoConstPtr&) {};
  const ros::Subscriber other = ros::NodeHandle(nh).subscribe<sensor_msgs::CameraInfo>("image", 1, ignore);
  LazyImageInput input(
      nh, ros::NodeHandle(nh, "node"), "/unstarted/node", [](const sensor_msgs::ImageConstPtr&, const cv::Mat&) {},
      [] { return true; });
  EXPECT_THROW(input.start(), ros::Exception);
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "test_lazy_outputs");
}
