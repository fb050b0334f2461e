#include <geometry_msgs/Vector3Stamped.h>
#include <gtest/gtest.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <cmath>
#include <opencv2/core.hpp>

#include "nodelets/factories.hpp"
#include "robot_vision/flow/dense_flow.hpp"
#include "robot_vision/flow/flow_drawing.hpp"
#include "support/receiver.hpp"
#include "support/run_tests.hpp"
#include "support/small_camera.hpp"

namespace
{

std::atomic<int> drawn{0};
std::atomic<int> averaged{0};

}  // namespace

namespace robot_vision
{

// These take the place of the core's functions, as a program's symbols go before those of its libraries, and count.

void flowToColors(const cv::Mat& flow, double /*max_speed*/, cv::Mat& bgr)
{
  ++drawn;
  bgr = cv::Mat::zeros(flow.size(), CV_8UC3);
}

cv::Point2d meanFlow(const cv::Mat& /*flow*/)
{
  ++averaged;
  return {3.0, 4.0};
}

}  // namespace robot_vision

using namespace robot_vision;

TEST(FlowOutputs, onlyWhatIsSubscribedToIsMade)
{
  SmallCamera camera;
  const auto nodelet = makeDenseFlow();
  nodelet->init("/dense_flow", {}, {});
  const Receiver<sensor_msgs::Image> flow("/dense_flow/flow");
  ASSERT_TRUE(camera.showUntil([&] { return flow.seconds().size() > 3; }));
  EXPECT_EQ(drawn, 0);
  EXPECT_EQ(averaged, 0);

  const Receiver<geometry_msgs::Vector3Stamped> mean("/dense_flow/mean");
  ASSERT_TRUE(camera.showUntil([&] { return mean.last() != nullptr; }));
  EXPECT_GT(averaged, 0);
  const auto velocity = mean.last()->vector;
  const double frames = 30.0 / velocity.x;  // that lie between the two images: a busy node leaves some out
  EXPECT_GT(frames, 0.5);
  EXPECT_NEAR(frames, std::round(frames), 1e-6);
  EXPECT_NEAR(velocity.y * frames, 40.0, 1e-6);
  EXPECT_EQ(drawn, 0);

  const Receiver<sensor_msgs::Image> colors("/dense_flow/processed_image");
  ASSERT_TRUE(camera.showUntil([&] { return colors.last() != nullptr; }));
  EXPECT_GT(drawn, 0);
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "test_flow_outputs");
}
