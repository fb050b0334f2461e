#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <sys/resource.h>

#include <algorithm>
#include <numeric>

#include "ros/images/bounded_reading.hpp"
#include "ros/images/image_message.hpp"

using namespace robot_vision;

namespace
{

using Bytes = std::vector<std::uint8_t>;

template <class Message>
Bytes serialized(const Message& message)
{
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// A serialized message that claims to have `count` bytes of data but has none.
template <class Message>
Bytes claiming(std::uint32_t count)
{
  Bytes bytes = serialized(Message());
  for (int i = 0; i < 4; ++i)
    bytes[bytes.size() - 4 + i] = static_cast<std::uint8_t>(count >> 8 * i);
  return bytes;
}

/// The peak memory of the process, bytes.
std::size_t peak()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) << 10;
}

}  // namespace

template <class Message>
class BoundedReadingOf : public testing::Test
{
};
using Messages = testing::Types<sensor_msgs::Image, sensor_msgs::CompressedImage>;
TYPED_TEST_SUITE(BoundedReadingOf, Messages);

TYPED_TEST(BoundedReadingOf, takesNoMemoryForMissingBytes)
{
  for (const std::uint32_t count : {1u, 0x80000000u, 0xFFFFFFFFu})
  {
    Bytes bytes = claiming<TypeParam>(count);
    TypeParam message;
    message.data = {1, 2, 3};  // left from the frame before
    const std::size_t before = peak();
    readBounded(bytes.data(), static_cast<std::uint32_t>(bytes.size()), message);
    EXPECT_TRUE(message.data.empty());
    EXPECT_LE(message.data.capacity(), 3u);
    EXPECT_LT(peak() - before, std::size_t{1} << 24);
  }
}

TYPED_TEST(BoundedReadingOf, readsCompleteMessages)
{
  TypeParam whole;
  whole.header.frame_id = "camera";
  whole.data.resize(1000);
  std::iota(whole.data.begin(), whole.data.end(), std::uint8_t{0});
  Bytes bytes = serialized(whole);
  TypeParam message;
  readBounded(bytes.data(), static_cast<std::uint32_t>(bytes.size()), message);
  EXPECT_EQ(message, whole);
}

TYPED_TEST(BoundedReadingOf, leavesNoDataInTruncatedMessages)
{
  TypeParam whole;
  whole.header.frame_id = "camera";
  whole.data.resize(20);
  const Bytes bytes = serialized(whole);
  for (std::size_t size = 0; size < bytes.size(); ++size)
  {
    Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    TypeParam message = whole;
    readBounded(part.data(), static_cast<std::uint32_t>(part.size()), message);
    EXPECT_TRUE(message.data.empty()) << size;
  }
}

/// A serialized CameraInfo that claims to have `count` coefficients, whose number follows the name of the model.
Bytes claimingCoefficients(const sensor_msgs::CameraInfo& info, std::uint32_t count)
{
  sensor_msgs::CameraInfo before = info;
  before.D.clear();
  Bytes bytes = serialized(before);
  const auto name = std::search(bytes.begin(), bytes.end(), info.distortion_model.begin(), info.distortion_model.end());
  const auto at = name + static_cast<std::ptrdiff_t>(info.distortion_model.size());
  for (int i = 0; i < 4; ++i)
    at[i] = static_cast<std::uint8_t>(count >> 8 * i);
  return bytes;
}

sensor_msgs::CameraInfo plumbBob()
{
  sensor_msgs::CameraInfo info;
  info.header.stamp = ros::Time(12.5);
  info.width = 640;
  info.distortion_model = "plumb_bob";
  info.D = {0.1, -0.2, 0.0, 0.0, 0.3};
  info.K[0] = 500.0;
  return info;
}

TEST(BoundedReadingOfCameraInfo, takesNoMemoryForMissingCoefficients)
{
  for (const std::uint32_t count :
       {100u, 0x20000000u, 0x40000001u, 0xFFFFFFFFu})  // times 8 bytes, two of them wrap to 0 and 8
  {
    Bytes bytes = claimingCoefficients(plumbBob(), count);
    sensor_msgs::CameraInfo info = plumbBob();
    const std::size_t before = peak();
    readBounded(bytes.data(), static_cast<std::uint32_t>(bytes.size()), info);
    EXPECT_EQ(info, sensor_msgs::CameraInfo());
    EXPECT_LT(peak() - before, std::size_t{1} << 24);
  }
}

TEST(BoundedReadingOfCameraInfo, readsCompleteMessages)
{
  Bytes bytes = serialized(plumbBob());
  sensor_msgs::CameraInfo info;
  readBounded(bytes.data(), static_cast<std::uint32_t>(bytes.size()), info);
  EXPECT_EQ(info, plumbBob());
}

/// A service call as roscpp passes it on.
ros::ServiceCallbackHelperCallParams callWith(const Bytes& bytes)
{
  ros::ServiceCallbackHelperCallParams call;
  call.request =
      ros::SerializedMessage(boost::shared_array<std::uint8_t>(new std::uint8_t[bytes.size()]), bytes.size());
  std::copy(bytes.begin(), bytes.end(), call.request.buf.get());
  call.request.message_start = call.request.buf.get();
  return call;
}

TEST(BoundedService, isCalledForCompleteRequestsOnly)
{
  int calls = 0;
  const ros::AdvertiseServiceOptions options =
      boundedService<sensor_msgs::SetCameraInfo>("set_camera_info",
                                                 [&calls](auto& request, auto& response)
                                                 {
                                                   EXPECT_EQ(request.camera_info, plumbBob());
                                                   response.status_message = "taken";
                                                   ++calls;
                                                   return true;
                                                 });
  auto whole = callWith(serialized(plumbBob()));
  EXPECT_TRUE(options.helper->call(whole));
  sensor_msgs::SetCameraInfo::Response response;
  constexpr std::uint32_t kPrefix = 5;  // bytes: the success flag and the length of the response
  ros::serialization::IStream answer(whole.response.buf.get() + kPrefix,
                                     static_cast<std::uint32_t>(whole.response.num_bytes) - kPrefix);
  ros::serialization::deserialize(answer, response);
  EXPECT_EQ(response.status_message, "taken");

  const std::size_t before = peak();
  auto cut = callWith(claimingCoefficients(plumbBob(), 0x20000000));
  EXPECT_THROW(options.helper->call(cut), ros::serialization::StreamOverrunException);
  EXPECT_LT(peak() - before, std::size_t{1} << 24);
  EXPECT_EQ(calls, 1);
}

TEST(BoundedService, takesNoMemoryForMissingSettings)
{
  const ros::AdvertiseServiceOptions options =
      boundedService<dynamic_reconfigure::Reconfigure>("set_parameters", [](auto&, auto&) { return true; });
  Bytes bytes = serialized(dynamic_reconfigure::Config());  // five lists; the first one contains bools
  bytes[3] = 0x04;                                          // claims 2^26 bools, which take 2.5 GB
  const std::size_t before = peak();
  auto call = callWith(bytes);
  EXPECT_THROW(options.helper->call(call), ros::serialization::StreamOverrunException);
  EXPECT_LT(peak() - before, std::size_t{1} << 24);
}

TEST(ImagePool, keepsNoMoreThanItsLimit)
{
  const ImagePool pool;
  pool.take({1 << 13, (1 << 14) + 1}, "mono8").reset();
  EXPECT_EQ(pool.kept(), 0u);
  std::vector<sensor_msgs::ImagePtr> held(6);
  for (sensor_msgs::ImagePtr& image : held)
    image = pool.take({1 << 13, 1 << 12}, "mono8");
  held.clear();
  EXPECT_GT(pool.kept(), 0u);
  EXPECT_LE(pool.kept(), ImagePool::kMaxKept);
}

TEST(ImagePool, releasesMemoryFarLargerThanThatInUse)
{
  const ImagePool pool;
  sensor_msgs::ImagePtr huge = pool.take({10000, 4000}, "mono8");
  sensor_msgs::ImagePtr usual = pool.take({640, 480}, "bgr8");
  huge.reset();
  EXPECT_GE(pool.kept(), 40000000u);
  usual.reset();
  EXPECT_EQ(pool.kept(), 640u * 480u * 3u);

  pool.take({10000, 4000}, "mono8").reset();
  pool.take({640, 480}, "bgr8").reset();  // reuses the memory of the huge image
  EXPECT_LT(pool.kept(), 40000000u);
}

TEST(ImageMaker, releasesTheMemoryOfAHugeImage)
{
  ImageMaker images;
  const auto make = [&images](cv::Size size)
  {
    const sensor_msgs::ImagePtr image = images.make(
        [size](cv::Mat& pixels)
        {
          pixels.create(size, CV_8UC3);
          return "bgr8";
        });
    EXPECT_EQ(image->data.size(), std::size_t(size.area()) * 3);
  };
  make({64, 48});
  make({1 << 13, 5500});
  EXPECT_LE(images.kept(), std::size_t{64 * 48 * 3});
  make({64, 48});
  make({64, 48});
  EXPECT_LE(images.kept(), std::size_t{2 * 64 * 48 * 3});
}

TEST(ImageMaker, takesWhatIsWrittenIntoLentMemoryAsItIs)
{
  ImageMaker images;
  cv::Mat written = images.lend();
  EXPECT_TRUE(written.empty());
  written = cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3));
  const auto make = [&]
  {
    return images.make(
        [&written](cv::Mat& pixels)
        {
          pixels = written;
          return "bgr8";
        });
  };
  EXPECT_NE(make()->data.data(), written.data);
  written = images.lend();
  written.setTo(cv::Scalar(4, 5, 6));
  const sensor_msgs::ImagePtr image = make();
  EXPECT_EQ(image->data.data(), written.data);
  EXPECT_EQ(image->data.front(), 4);
  EXPECT_NE(images.lend().data, written.data);
}
