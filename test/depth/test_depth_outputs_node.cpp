#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "nodelets/factories.hpp"
#include "robot_vision/depth/depth_points.hpp"
#include "robot_vision/depth/depth_registration.hpp"
#include "ros/depth/registration_input.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"

namespace
{

constexpr std::uint32_t kWidth = 64, kHeight = 48;  // px

std::atomic<int> registered{0};
std::atomic<int> placed{0};
std::atomic<int> colored{0};

}  // namespace

namespace robot_vision
{

// These take the place of the core's functions, as a program's symbols go before those of its libraries, and count.

void DepthRegistration::apply(const cv::Mat& depth, const std::string& /*encoding*/, cv::Mat& out)
{
  ++registered;
  depth.copyTo(out);
}

void DepthPoints::cloud(const cv::Mat& depth, const std::string& /*encoding*/, cv::Mat& xyz1) const
{
  ++placed;
  xyz1.create(depth.size(), CV_32FC4);
}

void DepthPoints::cloud(const cv::Mat& depth, const std::string& /*encoding*/, const cv::Mat& /*bgr*/,
                        cv::Mat& xyzrgb) const
{
  ++colored;
  xyzrgb.create(depth.size(), CV_32FC4);
}

}  // namespace robot_vision

namespace
{

using namespace robot_vision;

/// A depth camera and a color camera at 10 Hz of their own time.
class Cameras
{
public:
  Cameras()
  {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "rgb_eye";
    transform.child_frame_id = "depth_eye";
    transform.transform.rotation.w = 1.0;
    transforms_.sendTransform(transform);
  }

  /// Shows frames until there is an answer.
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

  bool isAskedForColors() const { return colors_.getNumSubscribers() > 0; }

  std::string encoding = "bgr8";     // of the color images
  std::uint8_t value = 3;            // of all bytes of images
  sensor_msgs::ImageConstPtr color;  // the color image that was sent last

private:
  void show()
  {
    const ros::Time stamp(100.0 + 0.1 * ++frames_);
    sendInfo(depth_info_, "depth_eye");
    sendInfo(color_info_, "rgb_eye");
    send(depths_, "depth_eye", "16UC1", 2, stamp);
    color = send(colors_, "rgb_eye", encoding, 3, stamp);
  }

  static void sendInfo(const ros::Publisher& to, const std::string& frame)
  {
    const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
    info->header.frame_id = frame;
    info->width = kWidth;
    info->height = kHeight;
    info->distortion_model = "plumb_bob";
    info->K = {60, 0, 32, 0, 60, 24, 0, 0, 1};
    to.publish(info);
  }

  sensor_msgs::ImageConstPtr send(const ros::Publisher& to, const std::string& frame, const std::string& layout,
                                  std::uint32_t bytes, const ros::Time& stamp) const
  {
    const auto image = boost::make_shared<sensor_msgs::Image>();
    image->header.stamp = stamp;
    image->header.frame_id = frame;
    image->encoding = layout;
    image->width = kWidth;
    image->height = kHeight;
    image->step = bytes * kWidth;
    image->data.resize(std::size_t{image->step} * kHeight, value);
    to.publish(image);
    return image;
  }

  ros::NodeHandle nh_{"/camera"};
  ros::Publisher depths_ = nh_.advertise<sensor_msgs::Image>("depth/image_raw", 1);
  ros::Publisher colors_ = nh_.advertise<sensor_msgs::Image>("rgb/image_raw", 1);
  ros::Publisher depth_info_ = nh_.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 1);
  ros::Publisher color_info_ = nh_.advertise<sensor_msgs::CameraInfo>("rgb/camera_info", 1);
  tf2_ros::StaticTransformBroadcaster transforms_;
  int frames_ = 0;
};

}  // namespace

TEST(DepthOutputs, onlyWhatIsSubscribedToIsMade)
{
  Cameras cameras;
  const auto nodelet = makeDepthRegistration();
  nodelet->init("/camera/registration", {}, {});
  const Receiver<sensor_msgs::CameraInfo> info("/camera/depth_registered/camera_info");
  ASSERT_TRUE(cameras.showUntil([&] { return info.seconds().size() > 3; }));
  EXPECT_EQ(registered + placed + colored, 0);
  EXPECT_EQ(info.last()->header.frame_id, "rgb_eye");

  const Receiver<sensor_msgs::Image> image("/camera/depth_registered/image_raw");
  ASSERT_TRUE(cameras.showUntil([&] { return image.seconds().size() > 3; }));
  EXPECT_GT(registered, 0);
  EXPECT_EQ(placed + colored, 0);
  EXPECT_FALSE(cameras.isAskedForColors());

  const Receiver<sensor_msgs::PointCloud2> points("/camera/depth_registered/points");
  ASSERT_TRUE(cameras.showUntil([&] { return points.last() != nullptr; }));
  EXPECT_TRUE(cameras.isAskedForColors());
  EXPECT_GT(colored, 0);
  EXPECT_EQ(placed, 0);
}

TEST(DepthOutputs, imagesOfAnotherEncodingDoNotChangeThoseBefore)
{
  Cameras cameras;
  const auto nodelet = makeDepthRegistration();
  nodelet->init("/camera/registration", {}, {});
  const Receiver<sensor_msgs::PointCloud2> points("/camera/depth_registered/points");
  std::vector<sensor_msgs::ImageConstPtr> before;
  const auto show = [&](std::size_t clouds)
  {
    return cameras.showUntil(
        [&]
        {
          if (cameras.encoding == "bgr8") before.push_back(cameras.color);
          return points.seconds().size() > clouds;
        });
  };
  ASSERT_TRUE(show(3));
  cameras.encoding = "rgb8";
  cameras.value = 7;
  ASSERT_TRUE(show(points.seconds().size() + 10));
  for (const sensor_msgs::ImageConstPtr& image : before)
    EXPECT_EQ(image->data, std::vector<std::uint8_t>(image->data.size(), 3));
}

TEST(RegistrationInput, exchangedCalibrationsAreNotExchangedAgain)
{
  Cameras cameras;
  const ros::NodeHandle nh("/camera",
                           {{"depth/camera_info", "rgb/camera_info"}, {"rgb/camera_info", "depth/camera_info"}});
  RegistrationFrame frame;
  std::atomic<bool> has_come{false};
  const auto keep = [&](const RegistrationFrame& one)
  {
    if (!has_come) frame = one;
    has_come = true;
    return true;
  };
  RegistrationInput input(nh, ros::NodeHandle("/exchanged"), "/exchanged", keep, [] { return true; });
  input.start();
  ASSERT_TRUE(cameras.showUntil([&] { return has_come.load(); }));
  EXPECT_EQ(frame.depth_info->header.frame_id, "rgb_eye");
  EXPECT_EQ(frame.color_info->header.frame_id, "depth_eye");
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "test_depth_outputs", 1);  // as in a manager, one callback at a time
}
