#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include <array>
#include <atomic>
#include <boost/make_shared.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "nodelets/factories.hpp"
#include "robot_vision/depth/depth_points.hpp"
#include "robot_vision/stereo/depth_from_disparity.hpp"
#include "robot_vision/stereo/epipolar.hpp"
#include "robot_vision/stereo/stereo_matcher.hpp"
#include "ros/stereo/stereo_input.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"

namespace
{

std::atomic<int> matched{0};
std::atomic<int> measured{0};
std::atomic<int> placed{0};
std::atomic<int> colored{0};
std::atomic<int> drawn{0};

}  // namespace

namespace robot_vision
{

// These take the place of the core's functions, as a program's symbols go before those of its libraries, and count.

void StereoMatcher::match(const cv::Mat& left, const cv::Mat& /*right*/, const std::string& /*encoding*/,
                          cv::Mat& disparity, const cv::Mat& /*left_seen*/, const cv::Mat& /*right_seen*/)
{
  ++matched;
  disparity = cv::Mat(left.size(), CV_32FC1, cv::Scalar(4.0));
}

void depthFromDisparity(const cv::Mat& disparity, const StereoGeometry& /*geometry*/, cv::Mat& out)
{
  ++measured;
  out = disparity.clone();
}

void DepthPoints::cloud(const cv::Mat& /*depth*/, const std::string& /*encoding*/, const cv::Mat& /*bgr*/,
                        cv::Mat& xyzrgb) const
{
  ++placed;
  xyzrgb.setTo(1.0);
}

void disparityToColors(const cv::Mat& disparity, double /*lowest*/, double /*highest*/, cv::Mat& out)
{
  ++colored;
  out = cv::Mat::zeros(disparity.size(), CV_8UC3);
}

void drawRectifiedPair(const cv::Mat& left, const cv::Mat& /*right*/, const EpipolarParams& /*params*/, cv::Mat& out)
{
  ++drawn;
  out = left.clone();
}

}  // namespace robot_vision

namespace
{

using namespace robot_vision;

constexpr std::uint32_t kWidth = 64, kHeight = 48;  // px

/// A calibrated pair at 10 Hz of its own time.
class Cameras
{
public:
  /// Shows pairs until there is an answer.
  template <class Answers>
  bool showUntil(const Answers& answered)
  {
    return waitFor(
        [&]
        {
          show();
          return answered();
        });
  }

private:
  struct Camera
  {
    ros::Publisher images, infos;
  };

  void show()
  {
    const ros::Time stamp(100.0 + 0.1 * ++frames_);
    for (const bool right : {false, true})
    {
      const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
      info->header.stamp = stamp;
      info->header.frame_id = right ? "right" : "left";
      info->width = kWidth;
      info->height = kHeight;
      info->distortion_model = "plumb_bob";
      info->K = {60, 0, 32, 0, 60, 24, 0, 0, 1};
      info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
      info->P = {60, 0, 32, right ? -6.0 : 0.0, 0, 60, 24, 0, 0, 0, 1, 0};
      cameras_[right ? 1 : 0].infos.publish(info);
      const auto image = boost::make_shared<sensor_msgs::Image>();
      image->header = info->header;
      image->encoding = "mono8";
      image->width = image->step = kWidth;
      image->height = kHeight;
      image->data.resize(std::size_t{kWidth} * kHeight);
      cameras_[right ? 1 : 0].images.publish(image);
    }
  }

  static Camera advertised(const std::string& side)
  {
    ros::NodeHandle nh(side);
    return {nh.advertise<sensor_msgs::Image>("image_raw", 1), nh.advertise<sensor_msgs::CameraInfo>("camera_info", 1)};
  }

  std::array<Camera, 2> cameras_ = {advertised("/left"), advertised("/right")};
  int frames_ = 0;
};

}  // namespace

TEST(StereoOutputs, onlyWhatIsSubscribedToIsMade)
{
  Cameras cameras;
  const auto nodelet = makeStereoMatcher();
  nodelet->init("/stereo_matcher", {}, {});
  const Receiver<sensor_msgs::Image> left("/stereo_matcher/left/image_rect_color");
  ASSERT_TRUE(cameras.showUntil([&] { return left.seconds().size() > 3; }));
  EXPECT_EQ(matched + measured + placed + colored + drawn, 0);

  const Receiver<sensor_msgs::Image> depth("/stereo_matcher/depth");
  ASSERT_TRUE(cameras.showUntil([&] { return depth.last() != nullptr; }));
  EXPECT_GT(matched, 0);
  EXPECT_GT(measured, 0);
  EXPECT_EQ(placed + colored + drawn, 0);

  const Receiver<sensor_msgs::PointCloud2> points("/stereo_matcher/points");
  ASSERT_TRUE(cameras.showUntil([&] { return points.last() != nullptr; }));
  EXPECT_GT(placed, 0);
  EXPECT_EQ(colored + drawn, 0);

  const Receiver<sensor_msgs::Image> colors("/stereo_matcher/disparity_image");
  ASSERT_TRUE(cameras.showUntil([&] { return colors.last() != nullptr; }));
  EXPECT_GT(colored, 0);
  EXPECT_EQ(drawn, 0);

  const Receiver<sensor_msgs::Image> rows("/stereo_matcher/epipolar");
  ASSERT_TRUE(cameras.showUntil([&] { return rows.last() != nullptr; }));
  EXPECT_GT(drawn, 0);
}

TEST(StereoInput, exchangedCamerasKeepTheirCalibrations)
{
  Cameras cameras;
  ros::M_string exchanged;
  for (const std::string topic : {"image_raw", "camera_info"})
  {
    exchanged["left/" + topic] = "right/" + topic;
    exchanged["right/" + topic] = "left/" + topic;
  }
  for (const std::string transport : {"auto", "raw", "shm"})
  {
    ros::param::set("/exchanged/image_transport", transport);
    StereoPair pair;
    std::atomic<bool> has_come{false};
    const auto keep = [&](const StereoFrame& frame)
    {
      if (!has_come) pair = frame.messages;
      has_come = true;
    };
    StereoInput input(ros::NodeHandle("/", exchanged), ros::NodeHandle("/exchanged"), "/exchanged", keep,
                      [] { return true; });
    input.start();
    ASSERT_TRUE(cameras.showUntil([&] { return has_come.load(); })) << transport;
    for (const std::size_t side : {kLeft, kRight})
    {
      const std::string expected = side == kLeft ? "right" : "left";
      EXPECT_EQ(pair.images[side]->header.frame_id, expected) << transport;
      EXPECT_EQ(pair.infos[side]->header.frame_id, expected) << transport;
    }
  }
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "test_stereo_outputs", 1);  // as in a manager, one callback at a time
}
