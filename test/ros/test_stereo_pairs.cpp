#include <gtest/gtest.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "ros/images/waiting_images.hpp"
#include "ros/stereo/stereo_pairs.hpp"
#include "ros/stereo/stereo_points.hpp"

using namespace robot_vision;

namespace
{

const StereoTopics kTopics = {{"/l/image_raw", "/r/image_raw"}, {"/l/camera_info", "/r/camera_info"}};

template <class Message>
boost::shared_ptr<Message> stamped(double time)
{
  const auto message = boost::make_shared<Message>();
  message->header.stamp = ros::Time(time);
  return message;
}

/// What is sent, and the pairs that it makes.
class Cameras
{
public:
  explicit Cameras(double slop = 0.0) : pairs(slop) {}

  void image(std::size_t side, double time, std::size_t bytes = 0)
  {
    const auto message = stamped<sensor_msgs::Image>(time);
    message->data.resize(bytes);
    note(pairs.add(side, sensor_msgs::ImageConstPtr(message)));
  }

  void info(std::size_t side, double time)
  {
    note(pairs.add(side, sensor_msgs::CameraInfoConstPtr(stamped<sensor_msgs::CameraInfo>(time))));
  }

  /// An image with its camera_info.
  void both(std::size_t side, double time)
  {
    info(side, time);
    image(side, time);
  }

  StereoPairs pairs;
  std::string found;  // the times of both images of each pair: "1-1 2-2 "

private:
  void note(const std::optional<StereoPair>& pair)
  {
    if (!pair) return;
    const auto seconds = [](const auto& message) { return std::to_string(message->header.stamp.sec); };
    for (const std::size_t side : {kLeft, kRight})
      EXPECT_EQ(pair->infos[side]->header.stamp, pair->images[side]->header.stamp);
    found += seconds(pair->images[kLeft]) + "-" + seconds(pair->images[kRight]) + " ";
  }
};

}  // namespace

TEST(StereoPairs, belongTogetherInWhicheverOrderTheyCome)
{
  // Which of left image, left info, right image and right info comes first, second, ...
  std::vector<int> order = {0, 1, 2, 3};
  do
  {
    Cameras cameras;
    for (const int what : order)
    {
      EXPECT_EQ(cameras.found, "");
      const std::size_t side = what < 2 ? kLeft : kRight;
      if (what % 2 == 0)
        cameras.image(side, 5.0);
      else
        cameras.info(side, 5.0);
    }
    EXPECT_EQ(cameras.found, "5-5 ");
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(StereoPairs, haveExactlyEqualStampsWithoutSlop)
{
  Cameras cameras;
  cameras.both(kLeft, 1.0);
  cameras.both(kRight, 1.0 + 1e-8);
  EXPECT_EQ(cameras.found, "");
  cameras.both(kRight, 1.0);
  EXPECT_EQ(cameras.found, "1-1 ");
}

TEST(StereoPairs, keepNothingThatIsOlder)
{
  Cameras cameras;
  for (const double time : {1.0, 2.0, 3.0})
    cameras.both(kLeft, time);
  cameras.both(kRight, 2.0);
  EXPECT_EQ(cameras.found, "2-2 ");
  cameras.both(kRight, 1.0);  // comes late
  EXPECT_EQ(cameras.found, "2-2 ");
  cameras.both(kRight, 3.0);
  EXPECT_EQ(cameras.found, "2-2 3-3 ");
  cameras.both(kRight, 3.0);  // the left one is used
  EXPECT_EQ(cameras.found, "2-2 3-3 ");
}

TEST(StereoPairs, areTheNearestWithSlop)
{
  Cameras cameras(0.4);
  cameras.both(kLeft, 10.0);
  cameras.both(kRight, 10.5);
  EXPECT_EQ(cameras.found, "");
  cameras.both(kRight, 11.25);
  cameras.image(kLeft, 11.0);
  EXPECT_EQ(cameras.found, "");  // its camera_info is missing
  cameras.both(kRight, 11.1);
  cameras.info(kLeft, 11.0);
  EXPECT_EQ(cameras.found, "11-11 ");
  cameras.both(kLeft, 11.5);  // 11.25 came before the one that was taken, and is gone
  EXPECT_EQ(cameras.found, "11-11 ");
}

TEST(StereoPairs, goOnWhenTimeBeginsAnew)
{
  Cameras cameras;
  for (const double time : {100.0, 101.0, 102.0})
  {
    cameras.both(kLeft, time);
    if (time < 102.0) cameras.both(kRight, time);
  }
  for (const double time : {1.0, 2.0})
  {
    cameras.both(kRight, time);
    cameras.both(kLeft, time);
  }
  EXPECT_EQ(cameras.found, "100-100 101-101 1-1 2-2 ");
}

TEST(StereoPairs, dropTheOldestOfMany)
{
  Cameras cameras;
  cameras.info(kLeft, 1.0);
  for (double time = 1.0; time < 2.0 + StereoPairs::kMaxImages; time += 1.0)
    cameras.image(kLeft, time);
  cameras.both(kRight, 1.0);
  EXPECT_EQ(cameras.found, "");  // the image has been dropped

  Cameras of_infos;
  for (double time = 1.0; time < 2.0 + StereoPairs::kMaxInfos; time += 1.0)
    of_infos.info(kLeft, time);
  of_infos.image(kLeft, 1.0);
  of_infos.both(kRight, 1.0);
  EXPECT_EQ(of_infos.found, "");

  Cameras of_bytes;
  of_bytes.info(kLeft, 1.0);
  of_bytes.info(kLeft, 2.0);
  of_bytes.image(kLeft, 1.0, kMaxWaitingBytes / 2 + 1);
  of_bytes.image(kLeft, 2.0, kMaxWaitingBytes / 2 + 1);
  of_bytes.both(kRight, 1.0);
  of_bytes.both(kRight, 2.0);
  EXPECT_EQ(of_bytes.found, "2-2 ");
}

TEST(StereoPairs, tellWhyThereAreNone)
{
  const auto problem = [](double slop, auto send)
  {
    Cameras cameras(slop);
    std::string told;
    for (std::size_t i = 0; i < StereoPairs::kMaxUnpaired && told.empty(); ++i)
    {
      send(cameras, 1.0 + static_cast<double>(i));
      told = cameras.pairs.problem(kLeft, kTopics);
    }
    return told;
  };
  EXPECT_EQ(problem(0.0, [](Cameras& cameras, double time) { cameras.both(kLeft, time); }),
            "no pairs for 20 images: nothing has come on /r/image_raw");
  EXPECT_EQ(problem(0.0, [](Cameras& cameras, double time) { cameras.both(kRight, time); }),
            "no pairs for 20 images: nothing has come on /l/image_raw");
  EXPECT_EQ(problem(0.0,
                    [](Cameras& cameras, double time)
                    {
                      cameras.both(kLeft, time);
                      cameras.image(kRight, time);
                    }),
            "no pairs for 20 images: nothing has come on /r/camera_info");
  EXPECT_EQ(problem(0.0,
                    [](Cameras& cameras, double time)
                    {
                      cameras.both(kLeft, time);
                      cameras.both(kRight, time + 0.5);
                    }),
            "no pairs for 20 images: the stamps on /l/image_raw and /r/image_raw do not meet: the newest are "
            "10.000000000 s and 10.500000000 s, must be equal; slop allows cameras that are not in step");
  EXPECT_EQ(problem(0.25,
                    [](Cameras& cameras, double time)
                    {
                      cameras.both(kLeft, time);
                      cameras.both(kRight, time + 0.5);
                    }),
            "no pairs for 20 images: the stamps on /l/image_raw and /r/image_raw do not meet: the newest are "
            "10.000000000 s and 10.500000000 s, must be at most slop, 0.25 s, apart");
  EXPECT_EQ(problem(0.0,
                    [](Cameras& cameras, double time)
                    {
                      cameras.both(kLeft, time);
                      cameras.image(kRight, time);
                      cameras.info(kRight, time + 0.5);
                    }),
            "no pairs for 20 images: the stamps on /r/image_raw and /r/camera_info do not meet: the newest are "
            "10.000000000 s and 10.500000000 s, must be equal");
}

TEST(StereoPairs, tellNothingWhilePairsCome)
{
  Cameras cameras;
  for (std::size_t i = 1; i < 3 * StereoPairs::kMaxUnpaired; ++i)
  {
    cameras.both(kLeft, static_cast<double>(i));
    cameras.both(kRight, static_cast<double>(i));
    EXPECT_EQ(cameras.pairs.problem(kLeft, kTopics), "");
    EXPECT_EQ(cameras.pairs.problem(kRight, kTopics), "");
  }
}

TEST(StereoPairs, tellOfEachLeftImageUntilAPairComes)
{
  for (const std::size_t side : {kLeft, kRight})
  {
    Cameras cameras;
    std::size_t told = 0;
    for (std::size_t i = 1; i <= 3 * StereoPairs::kMaxUnpaired; ++i)
    {
      cameras.both(side, static_cast<double>(i));
      told += !cameras.pairs.problem(side, kTopics).empty();
    }
    EXPECT_EQ(told, side == kLeft ? 2 * StereoPairs::kMaxUnpaired + 1 : 3) << side;
    cameras.both(1 - side, 3.0 * StereoPairs::kMaxUnpaired);
    EXPECT_EQ(cameras.pairs.problem(kLeft, kTopics), "");
  }
}

TEST(StereoPairs, tellOfNoRightImageWhileLeftOnesCome)
{
  Cameras cameras;
  std::size_t left = 0, right = 0;
  for (std::size_t i = 1; i <= 3 * StereoPairs::kMaxUnpaired; ++i)
  {
    cameras.both(kLeft, static_cast<double>(i));
    left += !cameras.pairs.problem(kLeft, kTopics).empty();
    cameras.both(kRight, static_cast<double>(i) + 0.5);
    right += !cameras.pairs.problem(kRight, kTopics).empty();
  }
  EXPECT_EQ(left, 5 * StereoPairs::kMaxUnpaired / 2);  // all but those among the first images of both
  EXPECT_EQ(right, 0U);
  for (std::size_t i = 1; i < StereoPairs::kMaxUnpaired; ++i)  // the left camera has ended after its last one
  {
    EXPECT_EQ(right, 0U);
    cameras.both(kRight, 1000.0 + static_cast<double>(i));
    right += !cameras.pairs.problem(kRight, kTopics).empty();
  }
  EXPECT_EQ(right, 1U);
}

TEST(StereoPairs, tellSinceHowManyImagesAPartnerThatComesSeldomHasBeenMissing)
{
  Cameras cameras;
  std::string told;
  for (std::size_t i = 1; i <= 60; ++i)
  {
    if (i % 30 == 0) cameras.both(kRight, static_cast<double>(i));
    cameras.both(kLeft, static_cast<double>(i));
    const std::string problem = cameras.pairs.problem(kLeft, kTopics);
    if (!problem.empty()) told = problem;
  }
  EXPECT_EQ(cameras.found, "30-30 60-60 ");
  EXPECT_EQ(told, "no pairs for 29 images: nothing has come on /r/image_raw");
}

TEST(StereoPairs, canBeForgotten)
{
  Cameras cameras;
  cameras.both(kLeft, 1.0);
  cameras.pairs.clear();
  cameras.both(kRight, 1.0);
  EXPECT_EQ(cameras.found, "");
}

namespace
{

/// A rectified camera of 2 x 1 pixels that sees the first one along its axis.
RectifiedCamera cameraOf(double focal_length)
{
  RectifiedCamera camera;
  camera.model.width = 2;
  camera.model.height = 1;
  camera.P = {focal_length, 0, 0, 0, 0, focal_length, 0, 0, 0, 0, 1, 0};
  return camera;
}

struct Word
{
  float place[3];
  std::uint32_t color;
};

/// The words of a pixel of a cloud of 2 x 1.
Word wordOf(const sensor_msgs::PointCloud2& cloud, std::size_t pixel)
{
  Word word{};
  std::memcpy(word.place, cloud.data.data() + 16 * pixel, sizeof(word.place));
  std::memcpy(&word.color, cloud.data.data() + 16 * pixel + 12, sizeof(word.color));
  return word;
}

}  // namespace

TEST(StereoPoints, haveTheWordsOfTheirPixels)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat depth = (cv::Mat_<float>(1, 2) << nan, 6.0F);
  const cv::Mat_<cv::Vec3b> bgr = (cv::Mat_<cv::Vec3b>(1, 2) << cv::Vec3b(1, 2, 3), cv::Vec3b(255, 254, 253));
  std_msgs::Header header;
  header.frame_id = "left_eye";
  StereoPoints points;
  const auto cloud = points.cloud(header, cameraOf(2.0), depth, bgr);
  EXPECT_EQ(cloud->header.frame_id, "left_eye");
  ASSERT_EQ(cloud->fields.size(), 4u);
  EXPECT_EQ(cloud->point_step, 16u);
  EXPECT_EQ(cloud->row_step, 32u);
  ASSERT_EQ(cloud->data.size(), 32u);
  EXPECT_TRUE(std::isnan(wordOf(*cloud, 0).place[2]));
  EXPECT_EQ(wordOf(*cloud, 0).color, 0x030201u);
  EXPECT_EQ(wordOf(*cloud, 1).place[0], 3.0F);  // (1 px - 0 px) / 2 px * 6 m
  EXPECT_EQ(wordOf(*cloud, 1).place[1], 0.0F);
  EXPECT_EQ(wordOf(*cloud, 1).place[2], 6.0F);
  EXPECT_EQ(wordOf(*cloud, 1).color, 0xFDFEFFu);
  EXPECT_EQ(wordOf(*points.cloud(header, cameraOf(3.0), depth, bgr), 1).place[0], 2.0F);
}
