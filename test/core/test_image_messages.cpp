#include <gtest/gtest.h>
#include <sensor_msgs/CompressedImage.h>
#include <sys/resource.h>

#include <numeric>

#include "ros/bounded_reading.hpp"
#include "ros/image_message.hpp"

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

/// A message that claims to have `count` bytes of data, and has none.
template <class Message>
Bytes claiming(std::uint32_t count)
{
  Bytes bytes = serialized(Message());
  for (int i = 0; i < 4; ++i)
    bytes[bytes.size() - 4 + i] = static_cast<std::uint8_t>(count >> 8 * i);
  return bytes;
}

/// The most memory that the process has ever had, bytes.
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

TYPED_TEST(BoundedReadingOf, takesNoMemoryForBytesThatDoNotCome)
{
  for (const std::uint32_t count : {1u, 0x80000000u, 0xFFFFFFFFu})
  {
    Bytes bytes = claiming<TypeParam>(count);
    TypeParam message;
    message.data = {1, 2, 3};  // of the frame before
    const std::size_t before = peak();
    readBounded(bytes.data(), static_cast<std::uint32_t>(bytes.size()), message);
    EXPECT_TRUE(message.data.empty());
    EXPECT_LE(message.data.capacity(), 3u);
    EXPECT_LT(peak() - before, std::size_t{1} << 24);
  }
}

TYPED_TEST(BoundedReadingOf, readsWhatIsWhole)
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

TYPED_TEST(BoundedReadingOf, leavesNoDataInWhatIsCutShort)
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

TEST(ImagePool, keepsNoMoreThanItMay)
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

TEST(ImagePool, letsGoWhatIsFarLargerThanWhatComes)
{
  const ImagePool pool;
  sensor_msgs::ImagePtr huge = pool.take({10000, 4000}, "mono8");
  sensor_msgs::ImagePtr usual = pool.take({640, 480}, "bgr8");
  huge.reset();
  EXPECT_GE(pool.kept(), 40000000u);
  usual.reset();
  EXPECT_EQ(pool.kept(), 640u * 480u * 3u);

  pool.take({10000, 4000}, "mono8").reset();
  pool.take({640, 480}, "bgr8").reset();  // in the memory of the huge one
  EXPECT_LT(pool.kept(), 40000000u);
}

TEST(ImageMaker, keepsNothingOfAHugeImage)
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
