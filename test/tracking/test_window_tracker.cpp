#include "robot_vision/tracking/window_tracker.hpp"

#include <gtest/gtest.h>

#include "core/tracking/window_fit.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

WindowTrackerParams params(const std::string& method)
{
  WindowTrackerParams made;
  made.method = method;
  made.subtract_background = false;
  made.min_area = 1.0;
  made.min_similarity = 0.0;
  return made;
}

}  // namespace

TEST(WindowTracker, survivesAnyImageAndKeepsItsWindowInside)
{
  for (const char* method : {"meanshift", "camshift"})
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 30), cv::Size(30, 1), cv::Size(47, 33), cv::Size(90, 5)})
    {
      WindowTracker tracker(params(method));
      tracker.update(0.0, noise({60, 40}, CV_8UC3), "bgr8");
      tracker.select({10, 10, 30, 20});
      double time = 0.0;
      for (const cv::Mat& image : {noise(size, CV_8UC3, 3), cv::Mat(size, CV_8UC3, cv::Scalar::all(0)),
                                   cv::Mat(size, CV_8UC3, cv::Scalar(200, 20, 20)), noise(size, CV_8UC3, 1)})
      {
        const cv::Mat before = image.clone();
        const auto found = tracker.update(time += 0.1, image, "bgr8");
        ASSERT_EQ(found.size(), 1U);
        EXPECT_TRUE(equal(image, before));
        EXPECT_EQ(tracker.backProjection().size(), size);
        if (!found[0].tracked) continue;
        EXPECT_FALSE(found[0].window.empty());
        EXPECT_EQ(found[0].window & cv::Rect({0, 0}, size), found[0].window);
        EXPECT_GE(found[0].confidence, 0.0);
        EXPECT_LE(found[0].confidence, 1.0);
      }
    }
}

TEST(WindowTracker, ABackProjectionThatIsHeldIsNotWrittenTo)
{
  WindowTracker tracker(params("camshift"));
  tracker.update(0.0, noise({60, 40}, CV_8UC3), "bgr8");
  tracker.select({10, 10, 30, 20});
  const cv::Mat held = tracker.backProjection(), before = held.clone();
  tracker.update(0.1, cv::Mat(40, 60, CV_8UC3, cv::Scalar(200, 20, 20)), "bgr8");
  EXPECT_TRUE(equal(held, before));
  EXPECT_FALSE(equal(tracker.backProjection(), before));
}

TEST(WindowTracker, AWindowAtTheBorderIsFollowedAlongIt)
{
  WindowTrackerParams used = params("camshift");
  used.min_similarity = 0.3;
  WindowTracker tracker(used);
  for (int x = 0; x < 60; ++x)
  {
    cv::Mat image(60, 100, CV_8UC3, cv::Scalar::all(128));
    const cv::Rect square(x, 0, 20, 20);
    image(square).setTo(cv::Scalar(20, 20, 200));
    tracker.update(x / 30.0, image, "bgr8");
    if (x == 0) tracker.select(square);
    const TrackedWindow found = tracker.objects().at(0);
    ASSERT_TRUE(found.tracked);
    EXPECT_NEAR(found.center.x, x + 9.5, 0.01);
    EXPECT_NEAR(found.center.y, 9.5, 0.01);
  }
}

TEST(WindowTracker, TheDensestOfLargeWindowsIsFound)
{
  cv::Mat projection(2900, 2920, CV_8UC1, cv::Scalar(0));
  const cv::Rect white(10, 0, 2910, 2900);  // whose sum is more than 2^31
  projection(white).setTo(255);
  EXPECT_EQ(densestWindow(projection, white.size()), white);
}

TEST(WindowTracker, refusesParametersOutOfRange)
{
  EXPECT_EQ(refusalWith(&WindowTrackerParams::method, "kalman"), "method is kalman, must be meanshift or camshift");
  EXPECT_EQ(refusalWith(&WindowTrackerParams::min_area, 0.0), "min_area is 0, must be from 1 to 1e+09");
}
