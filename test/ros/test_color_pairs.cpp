#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <string>

#include "ros/depth/cloud_pool.hpp"
#include "ros/depth/color_pairs.hpp"
#include "ros/images/stamps.hpp"
#include "ros/images/waiting_images.hpp"

using namespace robot_vision;

namespace
{

/// What is sent, in ms, and the pairs that it makes: "1000-1010 ".
class Cameras
{
public:
  explicit Cameras(double slop) : pairs(slop) {}

  void depth(int ms) { note(pairs.addDepth(imageOf(ms, 0))); }

  void color(int ms, std::size_t bytes = 0) { note(pairs.addColor(imageOf(ms, bytes))); }

  ColorPairs pairs;
  std::string found;

private:
  static sensor_msgs::ImageConstPtr imageOf(int ms, std::size_t bytes)
  {
    const auto message = boost::make_shared<sensor_msgs::Image>();
    message->header.stamp.fromNSec(static_cast<std::uint64_t>(ms) * 1000000);
    message->data.resize(bytes);
    return message;
  }

  void note(const std::optional<ColoredDepth>& pair)
  {
    if (!pair) return;
    const auto ms = [](const ros::Time& stamp) { return std::to_string(stamp.toNSec() / 1000000); };
    found += ms(pair->depth->header.stamp) + "-" + ms(pair->color->header.stamp) + " ";
  }
};

}  // namespace

TEST(ColorPairs, areFoundWhicheverComesFirst)
{
  Cameras cameras(0.02);
  cameras.depth(1000);
  cameras.color(1000);
  cameras.color(1033);
  cameras.depth(1033);
  EXPECT_EQ(cameras.found, "1000-1000 1033-1033 ");
  cameras.color(1034);  // nobody waits
  EXPECT_EQ(cameras.found, "1000-1000 1033-1033 ");
}

TEST(ColorPairs, areTheNearestOfThoseThatAreThere)
{
  Cameras cameras(0.02);
  cameras.color(1000);
  cameras.color(1015);
  cameras.color(1033);
  cameras.depth(1012);
  EXPECT_EQ(cameras.found, "1012-1015 ");
  cameras.depth(1060);
  cameras.color(1085);  // too late
  cameras.color(1075);
  EXPECT_EQ(cameras.found, "1012-1015 1060-1075 ");
}

TEST(ColorPairs, areNotThoseOfTheFrameBeforeOfFastCameras)
{
  Cameras cameras(0.02);
  cameras.color(983);
  cameras.color(1000);
  cameras.depth(1000);
  cameras.depth(1017);
  EXPECT_EQ(cameras.found, "1000-1000 ");
  cameras.color(1017);
  EXPECT_EQ(cameras.found, "1000-1000 1017-1017 ");
  cameras.depth(1033);
  cameras.depth(1050);  // the color of 1033 has been lost
  EXPECT_EQ(cameras.found, "1000-1000 1017-1017 1033-1017 ");
  cameras.color(1050);
  EXPECT_EQ(cameras.found, "1000-1000 1017-1017 1033-1017 1050-1050 ");
}

TEST(ColorPairs, waitForNoColorThatIsFartherAway)
{
  Cameras cameras(0.02);
  cameras.color(1000);
  cameras.color(1033);
  cameras.depth(1043);
  EXPECT_EQ(cameras.found, "1043-1033 ");
}

TEST(ColorPairs, haveEqualStampsWithoutSlop)
{
  Cameras cameras(0.0);
  cameras.depth(1000);
  cameras.color(1001);
  EXPECT_EQ(cameras.found, "");
  cameras.color(1000);
  EXPECT_EQ(cameras.found, "1000-1000 ");
}

TEST(ColorPairs, stampsAreComparedExactlyAndHoweverFarApart)
{
  const ros::Time now(1700000000, 5);
  EXPECT_EQ(secondsBetween(now, now), 0.0);
  EXPECT_EQ(secondsBetween(now, ros::Time(1700000000, 4)), 1e-9);
  EXPECT_EQ(secondsBetween(ros::Time(1700000000, 4), now), 1e-9);
  EXPECT_EQ(secondsBetween(ros::Time(), ros::Time(4294967295U, 0)), 4294967295.0);
}

TEST(ColorPairs, goOnWhenTimeBeginsAnew)
{
  Cameras cameras(0.02);
  cameras.color(90000);
  cameras.depth(90000);
  cameras.depth(1000);
  cameras.color(1000);
  EXPECT_EQ(cameras.found, "90000-90000 1000-1000 ");
}

TEST(ColorPairs, keepFewImages)
{
  Cameras cameras(0.02);
  for (std::size_t i = 0; i <= ColorPairs::kMaxColors; ++i)
    cameras.color(1000 + 100 * static_cast<int>(i));
  cameras.depth(1000);
  EXPECT_EQ(cameras.found, "");
  cameras.depth(1100);
  EXPECT_EQ(cameras.found, "1100-1100 ");
  Cameras large(0.02);
  large.color(1000, kMaxWaitingBytes / 2 + 1);
  large.color(2000, kMaxWaitingBytes / 2 + 1);
  large.depth(1000);
  EXPECT_EQ(large.found, "");
  large.depth(2000);
  EXPECT_EQ(large.found, "2000-2000 ");
}

TEST(ColorPairs, tellWhyThereAreNone)
{
  Cameras none(0.02), late(0.02);
  std::string told_of_none, told_of_late;
  for (std::size_t i = 0; i < ColorPairs::kMaxUnpaired; ++i)
  {
    EXPECT_EQ(told_of_none + told_of_late, "");
    none.depth(1000 + static_cast<int>(i));
    late.depth(1000 + 100 * static_cast<int>(i));
    late.color(1050 + 100 * static_cast<int>(i));
    told_of_none = none.pairs.problem("/d", "/c");
    told_of_late = late.pairs.problem("/d", "/c");
  }
  EXPECT_EQ(told_of_none, "no colors of points for 20 images: nothing has come on /c");
  EXPECT_EQ(told_of_late,
            "no colors of points for 20 images: the stamps on /d and /c do not meet: the newest are 2.900000000 s and "
            "2.950000000 s, must be at most slop, 0.02 s, apart");
  none.depth(3000);  // each is told of from now on
  EXPECT_EQ(none.pairs.problem("/d", "/c"), "no colors of points for 21 images: nothing has come on /c");
  none.color(3000);
  EXPECT_EQ(none.pairs.problem("/d", "/c"), "");
}

TEST(ColorPairs, tellSinceHowManyDepthsAColorThatComesSeldomHasBeenMissing)
{
  Cameras cameras(0.02);
  std::string told;
  for (int i = 0; i < 90; ++i)
  {
    if (i % 30 == 0) cameras.color(1000 + 33 * i);
    cameras.depth(1000 + 33 * i);
    const std::string problem = cameras.pairs.problem("/d", "/c");
    EXPECT_EQ(problem.empty(), i % 30 < static_cast<int>(ColorPairs::kMaxUnpaired)) << i;
    if (!problem.empty()) told = problem;
  }
  EXPECT_EQ(cameras.found, "1000-1000 1990-1990 2980-2980 ");
  EXPECT_EQ(told,
            "no colors of points for 29 images: the stamps on /d and /c do not meet: the newest are 3.937000000 s and "
            "2.980000000 s, must be at most slop, 0.02 s, apart");
}

TEST(ColorPairs, tellThatDepthsComeTooLate)
{
  Cameras cameras(0.02);
  std::string told;
  for (int i = 0; i < static_cast<int>(ColorPairs::kMaxUnpaired); ++i)
  {
    cameras.color(1200 + 33 * i);
    cameras.color(1217 + 33 * i);
    cameras.depth(1000 + 33 * i);
    told = cameras.pairs.problem("/d", "/c");
  }
  EXPECT_EQ(told,
            "no colors of points for 20 images: the images on /d come too late: the newest is of 1.627000000 s, and of "
            "those on /c only 4 are kept, from 1.794000000 s on");
}

TEST(ColorPairs, canBeForgotten)
{
  Cameras cameras(0.02);
  cameras.depth(1000);
  cameras.pairs.clear();
  cameras.color(1000);
  EXPECT_EQ(cameras.found, "");
}

TEST(CloudPool, messagesAreUsedAgainWhenNobodyHasThem)
{
  const CloudPool pool;
  sensor_msgs::PointCloud2Ptr cloud = pool.take({8, 6}, true);
  ASSERT_EQ(cloud->data.size(), 8u * 6u * 16u);
  ASSERT_EQ(cloud->fields.size(), 4u);
  EXPECT_EQ(cloud->fields[3].name, "rgb");
  EXPECT_EQ(cloud->fields[3].offset, 12u);
  const void* const first = cloud.get();
  const sensor_msgs::PointCloud2Ptr other = pool.take({8, 6}, true);
  EXPECT_NE(other.get(), first);
  cloud.reset();
  cloud = pool.take({4, 3}, false);
  EXPECT_EQ(cloud.get(), first);
  EXPECT_EQ(cloud->fields.size(), 3u);
  EXPECT_EQ(cloud->row_step, 64u);
  EXPECT_EQ(cloud->data.size(), 4u * 3u * 16u);
  cv::Mat points = writablePoints(*cloud);
  EXPECT_EQ(points.data, cloud->data.data());
  EXPECT_EQ(points.size(), cv::Size(4, 3));
}
