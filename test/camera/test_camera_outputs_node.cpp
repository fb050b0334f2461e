#include <gtest/gtest.h>
#include <image_transport/image_transport.h>
#include <robot_vision/ShmImage.h>
#include <ros/ros.h>
#include <sensor_msgs/CompressedImage.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <thread>

#include "robot_vision/image/jpeg.hpp"
#include "ros/camera/camera_outputs.hpp"
#include "ros/images/newest_worker.hpp"
#include "ros/transports/compression.hpp"
#include "ros/transports/plugins/transport_publisher.hpp"
#include "support/images.hpp"
#include "support/receiver.hpp"
#include "support/refusal.hpp"
#include "support/run_tests.hpp"

using namespace robot_vision;

namespace
{

const ros::Time kStamp(12, 34);

const cv::Mat kImage = noise({64, 48}, CV_8UC3);

/// A JPEG that a decoder refuses.
Bytes damagedJpeg()
{
  Bytes jpeg = jpegOf(kImage);
  jpeg.erase(jpeg.end() - 200, jpeg.end() - 2);
  return jpeg;
}

Frame frameOf(const cv::Mat& image, const std::string& encoding)
{
  Frame frame;
  frame.image = image;
  frame.encoding = encoding;
  return frame;
}

Frame frameOf(const Bytes& jpeg)
{
  return frameOf(rowOf(jpeg), "jpeg");
}

}  // namespace

/// The outputs of a camera in the test's private namespace.
class Outputs : public testing::Test
{
protected:
  void make(const std::string& output_encoding = "auto")
  {
    CameraOutputs::Params params;
    params.output_encoding = output_encoding;
    outputs_ = std::make_unique<CameraOutputs>(ros::NodeHandle("~"), params, [] {});
    ASSERT_FALSE(outputs_->wanted());
  }

  void waitUntilWanted()
  {
    ASSERT_TRUE(waitFor([this] { return outputs_->wanted(); }));
  }

  void publish(const Frame& frame) { outputs_->publish(frame, kStamp); }

  /// What a topic's only subscriber gets of a frame.
  template <class Message>
  boost::shared_ptr<const Message> published(const std::string& topic, const Frame& frame)
  {
    Receiver<Message> receiver(topic);
    waitUntilWanted();
    publish(frame);
    return receiver.wait();
  }

  /// The number of advertised topics with this name: 0 or 1.
  static long topics(const std::string& name)
  {
    ros::V_string all;
    ros::this_node::getAdvertisedTopics(all);
    return std::count(all.begin(), all.end(), ros::NodeHandle("~").resolveName(name));
  }

  std::unique_ptr<CameraOutputs> outputs_;
};

TEST_F(Outputs, passJpegOnUntouched)
{
  make();
  const Bytes jpeg = damagedJpeg();
  const auto message = published<sensor_msgs::CompressedImage>("image_raw/compressed", frameOf(jpeg));
  EXPECT_EQ(message->data, jpeg);
  EXPECT_EQ(message->format, "bgr8; jpeg compressed bgr8");
  EXPECT_EQ(message->header.stamp, kStamp);
  EXPECT_EQ(message->header.frame_id, "head_camera");
}

TEST_F(Outputs, sayThatAJpegIsGray)
{
  make();
  const Bytes jpeg = jpegOf(converted(kImage, cv::COLOR_BGR2GRAY));
  const auto message = published<sensor_msgs::CompressedImage>("image_raw/compressed", frameOf(jpeg));
  EXPECT_EQ(message->format, "mono8; jpeg compressed ");
}

TEST_F(Outputs, decodeJpegForSubscribersOfPixels)
{
  make();
  const Bytes jpeg = jpegOf(kImage);
  const auto raw = published<sensor_msgs::Image>("image_raw", frameOf(jpeg));
  EXPECT_EQ(raw->encoding, "bgr8");
  EXPECT_TRUE(equal(viewPixels(*raw), cv::imdecode(jpeg, cv::IMREAD_COLOR)));
}

TEST_F(Outputs, takeTheLumaOfJpegForGray)
{
  make();
  const Bytes jpeg = jpegOf(kImage);
  const auto mono = published<sensor_msgs::Image>("image_mono", frameOf(jpeg));
  EXPECT_EQ(mono->encoding, "mono8");
  EXPECT_TRUE(equal(viewPixels(*mono), cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE)));
}

TEST_F(Outputs, tellTheCamerasSizeWithoutDecoding)
{
  make();
  const Frame frame = frameOf(damagedJpeg());
  Receiver<sensor_msgs::CameraInfo> info("camera_info");
  Receiver<sensor_msgs::CompressedImage> compressed("image_raw/compressed");
  waitUntilWanted();
  ASSERT_TRUE(waitFor(
      [&]
      {
        publish(frame);
        return info.last() && compressed.last();
      }));
  EXPECT_EQ(info.last()->width, 64u);
  EXPECT_EQ(info.last()->height, 48u);
  EXPECT_EQ(info.last()->header.stamp, compressed.last()->header.stamp);
  EXPECT_EQ(info.last()->header.frame_id, compressed.last()->header.frame_id);
}

// Recorders subscribe to all topics. So a topic that can never have depths is not advertised, and one that has none now
// does not cause a JPEG to be decoded.
TEST_F(Outputs, doNotDecodeJpegForCompressedDepth)
{
  make();
  EXPECT_EQ(topics("image_raw/compressedDepth"), 0);
  EXPECT_EQ(topics("image_mono/compressedDepth"), 0);
  EXPECT_EQ(topics("image_mono/compressed"), 1);
  outputs_.reset();

  make("native");
  Receiver<sensor_msgs::CompressedImage> depth("image_raw/compressedDepth");
  waitUntilWanted();
  EXPECT_EQ(refusal([&] { publish(frameOf(damagedJpeg())); }), "");
}

TEST_F(Outputs, compressDepthImages)
{
  make("native");
  const Frame frame = frameOf(cv::Mat(48, 64, CV_16UC1, cv::Scalar(1234)), "mono16");
  const auto depth = published<sensor_msgs::CompressedImage>("image_raw/compressedDepth", frame);
  EXPECT_EQ(depth->format, "mono16; compressedDepth png");
}

TEST_F(Outputs, makeEqualOutputsOnce)
{
  make("mono8");
  Receiver<sensor_msgs::Image> raw("image_raw");
  Receiver<sensor_msgs::Image> mono("image_mono");
  const Bytes jpeg = jpegOf(kImage);
  ASSERT_TRUE(waitFor(
      [&]
      {
        publish(frameOf(jpeg));
        return raw.last() && mono.last();
      }));
  publish(frameOf(jpeg));
  EXPECT_TRUE(waitFor([&] { return raw.last() == mono.last(); }));
  EXPECT_TRUE(equal(viewPixels(*mono.last()), cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE)));
}

TEST_F(Outputs, keepTheMemoryThatTheyShareWhileGrayIsPublishedToo)
{
  make();
  Receiver<robot_vision::ShmImage> shared("image_raw/shm");
  Receiver<sensor_msgs::Image> mono("image_mono");
  std::set<std::uint64_t> memory;
  std::uint32_t sent = 0;
  const auto sends = [&]
  {
    outputs_->publish(frameOf(noise({320, 240}, CV_8UC3), "bgr8"), ros::Time(++sent));
    if (const auto message = shared.last()) memory.insert(message->memory);
    return mono.last() && shared.last() && shared.last()->header.stamp.sec >= 30;
  };
  ASSERT_TRUE(waitFor(sends));
  EXPECT_LE(memory.size(), 4U);
}

TEST_F(Outputs, tellTheSizeWithoutReadingPixels)
{
  make();
  constexpr std::size_t kBytes = 64 * 48 * 2;
  void* const unreadable = mmap(nullptr, kBytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(unreadable, MAP_FAILED);
  const Frame frame = frameOf(cv::Mat(48, 64, CV_8UC2, unreadable), "yuv422_yuy2");
  const auto info = published<sensor_msgs::CameraInfo>("camera_info", frame);
  EXPECT_EQ(info->width, 64u);
  EXPECT_EQ(info->height, 48u);
  munmap(unreadable, kBytes);
}

TEST_F(Outputs, refuseTruncatedJpeg)
{
  make();
  const Bytes whole = jpegOf(kImage);
  Receiver<sensor_msgs::CompressedImage> compressed("image_raw/compressed");
  waitUntilWanted();
  EXPECT_THROW(publish(frameOf(Bytes(whole.begin(), whole.begin() + whole.size() / 2))), std::invalid_argument);
  publish(frameOf(whole));  // which would come second
  EXPECT_EQ(compressed.wait()->data, whole);
  EXPECT_EQ(compressed.seconds().size(), 1u);
}

// An image that cannot be made for one subscriber must not keep the others from theirs, above all not camera_info.
TEST_F(Outputs, goOnWithTheOthersIfOneFails)
{
  make("native");
  const Frame frame = frameOf(cv::Mat(1, kLongestJpegSide + 1, CV_16UC1, cv::Scalar(1234)), "mono16");
  Receiver<sensor_msgs::CompressedImage> compressed("image_raw/compressed");
  Receiver<sensor_msgs::Image> raw("image_raw");
  Receiver<sensor_msgs::CameraInfo> info("camera_info");
  Receiver<sensor_msgs::CompressedImage> depth("image_raw/compressedDepth");
  Receiver<sensor_msgs::Image> mono("image_mono");
  bool refused = false;  // the compression fails in a thread, so the next frame reports it
  EXPECT_TRUE(waitFor(
      [&]
      {
        refused = !refusal([&] { publish(frame); }).empty() || refused;
        return raw.last() && info.last() && depth.last() && mono.last() && refused;
      }));
  EXPECT_FALSE(compressed.last());
}

TEST_F(Outputs, passDamagedJpegOnWhereNoPixelsAreNeeded)
{
  make();
  const Frame frame = frameOf(damagedJpeg());
  Receiver<sensor_msgs::Image> raw("image_raw");
  Receiver<sensor_msgs::CameraInfo> info("camera_info");
  ASSERT_TRUE(waitFor([&] { return refusal([&] { publish(frame); }) != ""; }));  // raw is wanted
  EXPECT_FALSE(info.last());
  Receiver<sensor_msgs::CompressedImage> compressed("image_raw/compressed");
  EXPECT_TRUE(waitFor(
      [&]
      {
        EXPECT_NE(refusal([&] { publish(frame); }), "");
        return compressed.last() && info.last();
      }));
  EXPECT_FALSE(raw.last());
}

TEST_F(Outputs, compressPixelsAsThePluginDoes)
{
  ros::NodeHandle("~").setParam("image_raw/compressed/jpeg_quality", 40);
  make();
  const auto message = published<sensor_msgs::CompressedImage>("image_raw/compressed", frameOf(kImage, "bgr8"));
  EXPECT_EQ(message->data, jpegOf(kImage, {cv::IMWRITE_JPEG_QUALITY, 40}));
  EXPECT_EQ(message->format, "bgr8; jpeg compressed bgr8");
  ros::NodeHandle("~").deleteParam("image_raw/compressed/jpeg_quality");
}

TEST_F(Outputs, keepTheListOfDisabledPlugins)
{
  ros::NodeHandle pnh("~");
  make();
  EXPECT_EQ(topics("image_raw/compressed"), 1);
  EXPECT_EQ(topics("image_raw/theora"), 1);
  EXPECT_FALSE(pnh.hasParam("image_raw/disable_pub_plugins"));

  outputs_.reset();
  const std::vector<std::string> disabled = {"image_transport/theora", "image_transport/compressed"};
  pnh.setParam("image_raw/disable_pub_plugins", disabled);
  make();
  EXPECT_EQ(topics("image_raw/compressed"), 0);
  EXPECT_EQ(topics("image_raw/theora"), 0);
  EXPECT_EQ(topics("image_mono/compressed"), 1);
  std::vector<std::string> after;
  pnh.getParam("image_raw/disable_pub_plugins", after);
  EXPECT_EQ(after, disabled);
  pnh.deleteParam("image_raw/disable_pub_plugins");
}

TEST_F(Outputs, forgetWhatAKilledNodeHasDisabled)
{
  ros::NodeHandle pnh("~");
  const std::string parameter = "image_raw/disable_pub_plugins", own = "robot_vision/own_from_here";
  pnh.setParam(parameter, std::vector<std::string>{own, "image_transport/compressed", "image_transport/theora"});
  make();
  EXPECT_EQ(topics("image_raw/compressed"), 1);
  EXPECT_EQ(topics("image_raw/theora"), 1);
  EXPECT_FALSE(pnh.hasParam(parameter));

  outputs_.reset();
  const std::vector<std::string> of_user = {"image_transport/theora"};
  pnh.setParam(parameter, std::vector<std::string>{of_user.front(), own, "image_transport/compressed"});
  make();
  EXPECT_EQ(topics("image_raw/compressed"), 1);
  EXPECT_EQ(topics("image_raw/theora"), 0);
  std::vector<std::string> after;
  pnh.getParam(parameter, after);
  EXPECT_EQ(after, of_user);
  pnh.deleteParam(parameter);
}

TEST_F(Outputs, leaveAListOfDisabledPluginsThatIsNone)
{
  ros::NodeHandle pnh("~");
  pnh.setParam("image_raw/disable_pub_plugins", 7);
  make();
  EXPECT_EQ(topics("image_raw/theora"), 1);
  int after = 0;
  pnh.getParam("image_raw/disable_pub_plugins", after);
  EXPECT_EQ(after, 7);
  pnh.deleteParam("image_raw/disable_pub_plugins");
}

namespace
{

/// Holds a thread up until the test lets it go on.
class Gate
{
public:
  /// Returns when the test has called open().
  void pass()
  {
    ++waiting_;
    opened_.wait();
  }

  bool reached() const { return waiting_ > 0; }
  void open() { open_.set_value(); }

private:
  std::atomic<int> waiting_{0};
  std::promise<void> open_;
  std::shared_future<void> opened_{open_.get_future()};
};

/// A transport that waits for a gate before it sends.
class SlowPublisher
  : public TransportPublisher<sensor_msgs::CompressedImage, CompressedPublisherConfig, CompressionParams>
{
public:
  explicit SlowPublisher(Gate& gate) : TransportPublisher(toCompressionParams), gate_(gate) {}
  ~SlowPublisher() override { SlowPublisher::shutdown(); }

  std::string getTransportName() const override { return "slow"; }

private:
  void send(const sensor_msgs::Image& message, const CompressionParams&, const PublishFn& publish_fn) const override
  {
    gate_.pass();
    sensor_msgs::CompressedImage sent;
    sent.header = message.header;
    publish_fn(sent);
  }

  Gate& gate_;
};

template <class Message = sensor_msgs::Image>
boost::shared_ptr<Message> numbered(int number)
{
  auto message = boost::make_shared<Message>();
  message->header.stamp = ros::Time(number, 0);
  return message;
}

using List = std::vector<std::uint32_t>;

}  // namespace

// Recorders subscribe to all transports, and the slowest of them must not limit the camera's rate.
TEST(Transports, doNotDelayOthersWhenSlow)
{
  ros::NodeHandle nh("~");
  Gate gate;
  SlowPublisher slow(gate);
  slow.advertise(nh, nh.resolveName("video"), 100, false);
  ros::Publisher raw = nh.advertise<sensor_msgs::Image>("video", 100);
  const Receiver<sensor_msgs::Image> images("video");
  const Receiver<sensor_msgs::CompressedImage> sent("video/slow");
  ASSERT_TRUE(waitFor([&] { return raw.getNumSubscribers() == 1 && slow.getNumSubscribers() == 1; }));
  const auto publish = [&](int number)
  {
    const sensor_msgs::ImageConstPtr image = numbered(number);
    const image_transport::PublisherPlugin& plugin = slow;
    plugin.publish(image);
    raw.publish(image);
  };
  publish(1);
  ASSERT_TRUE(waitFor([&] { return gate.reached(); }));
  for (int number = 2; number <= 9; ++number)
    publish(number);
  EXPECT_TRUE(waitFor([&] { return images.seconds().size() == 9; }));
  EXPECT_EQ(sent.seconds(), List{});
  gate.open();
  EXPECT_TRUE(waitFor([&] { return sent.seconds() == List{1, 9}; }));
  publish(10);
  EXPECT_TRUE(waitFor([&] { return sent.seconds() == List{1, 9, 10}; }));
}

TEST(Transports, sendNothingAfterShutdown)
{
  ros::NodeHandle nh("~");
  Gate gate;
  SlowPublisher slow(gate);
  slow.advertise(nh, nh.resolveName("video"), 100, false);
  const Receiver<sensor_msgs::CompressedImage> sent("video/slow");
  ASSERT_TRUE(waitFor([&] { return slow.getNumSubscribers() == 1; }));
  const image_transport::PublisherPlugin& plugin = slow;
  plugin.publish(*numbered(1));
  ASSERT_TRUE(waitFor([&] { return gate.reached(); }));
  plugin.publish(*numbered(2));
  std::thread ending([&slow] { slow.shutdown(); });
  gate.open();
  ending.join();
  plugin.publish(*numbered(3));
  ros::Publisher next = nh.advertise<sensor_msgs::CompressedImage>("video/slow", 100);
  ASSERT_TRUE(waitFor([&] { return next.getNumSubscribers() == 1; }));
  next.publish(numbered<sensor_msgs::CompressedImage>(4));
  EXPECT_TRUE(waitFor([&] { return !sent.seconds().empty() && sent.seconds().back() == 4; }));
  for (const std::uint32_t number : sent.seconds())  // the first two may have been sent before the end, or lost
    EXPECT_NE(number, 3U);
}

namespace
{

Gate* encoder_gate = nullptr;

sensor_msgs::CompressedImage encodedSlowly(const sensor_msgs::Image& message, const CompressionParams&)
{
  if (message.header.stamp.sec == 1) encoder_gate->pass();
  if (message.header.stamp.sec == 3) throw std::invalid_argument("three");
  sensor_msgs::CompressedImage encoded;
  encoded.header = message.header;
  return encoded;
}

}  // namespace

TEST(Transports, keepTheOrderOfEncodedAndPassedOnImages)
{
  ros::NodeHandle nh("~");
  Gate gate;
  encoder_gate = &gate;
  CompressedOutput output(nh, nh.resolveName("mixed"), toCompressionParams, encodedSlowly,
                          [](const ros::SingleSubscriberPublisher&) {});
  const Receiver<sensor_msgs::CompressedImage> sent("mixed");
  ASSERT_TRUE(waitFor([&] { return output.wanted(); }));
  output.publish(numbered(1));
  ASSERT_TRUE(waitFor([&] { return gate.reached(); }));
  output.publish(numbered(2));
  gate.open();
  output.passOn(*numbered<sensor_msgs::CompressedImage>(5));
  EXPECT_TRUE(waitFor([&] { return !sent.seconds().empty() && sent.seconds().back() == 5; }));
  const List received = sent.seconds();
  EXPECT_EQ(received.front(), 1U);
  EXPECT_TRUE(std::is_sorted(received.begin(), received.end()));
  std::string error;
  const auto isRefused = [&]
  {
    if (error.empty()) error = refusal([&] { output.publish(numbered(3)); });
    return error == "three";
  };
  EXPECT_TRUE(waitFor(isRefused));
  const auto goesOn = [&]
  {
    refusal([&] { output.publish(numbered(6)); });  // may still throw for image 3
    return sent.seconds().back() == 6;
  };
  EXPECT_TRUE(waitFor(goesOn));
}

TEST(NewestWorker, runsOneJobAtATimeAndNoneAfterItsEnd)
{
  Gate gate;
  std::vector<int> done;
  NewestWorker worker;
  worker.settle();  // there is nothing to wait for
  worker.post(
      [&]
      {
        gate.pass();
        done.push_back(1);
      });
  ASSERT_TRUE(waitFor([&] { return gate.reached(); }));
  worker.post([&] { done.push_back(2); });
  gate.open();
  worker.settle();
  EXPECT_TRUE(done == std::vector<int>({1}) || done == std::vector<int>({1, 2}));
  std::promise<void> third;
  worker.post([&] { third.set_value(); });
  third.get_future().wait();
  worker.stop();
  worker.post([&] { done.push_back(4); });
  worker.stop();
  EXPECT_EQ(std::count(done.begin(), done.end(), 4), 0);
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "camera_outputs");
}
