#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "support/objects.hpp"

using namespace robot_vision;

TEST(ObjectFlow, measuresTheFlowOfTheWholeImage)
{
  ObjectTracker tracker;
  EXPECT_TRUE(tracker.flow().empty());
  const cv::Mat large = blots({340, 260}, 6);
  tracker.update(1.0, large(cv::Rect({10, 10}, kImageSize)), "bgr8");
  EXPECT_TRUE(tracker.flow().empty());
  tracker.update(1.1, large(cv::Rect({7, 14}, kImageSize)), "bgr8");  // all moves by 3 px right, 4 px up
  const std::vector<FlowPoint> flow = tracker.flow(100);
  EXPECT_GT(flow.size(), 60U);
  EXPECT_LE(flow.size(), 100U);
  // Nearer to the border, a part of a point's window is outside of one of the two images.
  const cv::Rect2f whole({8.0F, 8.0F}, cv::Size2f(kImageSize) - cv::Size2f(16.0F, 16.0F));
  std::size_t right = 0;
  for (const FlowPoint& point : flow)
  {
    const double error = distance(point.velocity, {30.0, -40.0});
    if (whole.contains(point.position)) EXPECT_LT(error, 0.5) << point.position;
    right += error < 2.0;
  }
  EXPECT_GE(static_cast<double>(right), 0.9 * static_cast<double>(flow.size()));
  EXPECT_THROW(tracker.flow(0), std::invalid_argument);
}

TEST(ObjectFlow, isNoneAcrossAPause)
{
  ObjectTracker tracker;
  const cv::Mat still = blots(kImageSize, 6);
  tracker.update(1.0, still, "bgr8");
  tracker.update(3.0, still, "bgr8");
  EXPECT_FALSE(tracker.flow().empty());
  tracker.update(5.1, still, "bgr8");
  EXPECT_TRUE(tracker.flow().empty());
  tracker.update(5.2, still, "bgr8");
  EXPECT_FALSE(tracker.flow().empty());
}

TEST(ObjectFlow, isThatOfTheCoverOrOfTheBackground)
{
  const cv::Mat cover = blots({120, 160}, 3);
  ObjectTracker tracker;
  std::size_t all = 0, wrong = 0;
  for (int frame = 0; frame <= 10; ++frame)
  {
    const double left = 12.0 * frame;  // the cover moves by 12 px per frame in front of the background, which rests
    tracker.update(frame * kPeriod, with(cover, {left + 59.5, 119.5}), "bgr8");
    for (const FlowPoint& point : tracker.flow())
    {
      const cv::Point2d moved = point.velocity * kPeriod;
      ++all;
      wrong += distance(moved, {12.0, 0.0}) > 1.5 && distance(moved, {0.0, 0.0}) > 1.5;
    }
  }
  EXPECT_GT(all, 1000U);
  EXPECT_LT(static_cast<double>(wrong), 0.02 * static_cast<double>(all));
}

TEST(ObjectFlow, endsAtTheBorder)
{
  const cv::Mat large = blots({420, 340}, 6);
  for (const cv::Point& shift : {cv::Point(6, 0), cv::Point(-6, 0), cv::Point(0, 6), cv::Point(0, -6)})
  {
    ObjectTracker tracker;
    tracker.update(0.0, large(cv::Rect({50, 50}, kImageSize)), "bgr8");
    tracker.update(kPeriod, large(cv::Rect(cv::Point(50, 50) + shift, kImageSize)), "bgr8");
    const std::vector<FlowPoint> flow = tracker.flow();
    EXPECT_GT(flow.size(), 100U);
    for (const FlowPoint& point : flow)
      EXPECT_TRUE(cv::Rect2f(0.0F, 0.0F, 319.001F, 239.001F).contains(point.position)) << point.position;
  }
}
