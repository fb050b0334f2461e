#include "robot_vision/tracking/object_tracker.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "support/images.hpp"
#include "support/objects.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

std::string refusalOf(const cv::Rect& region)
{
  ObjectTracker tracker;
  tracker.update(0.0, with(kObject, kStart), "bgr8");
  return refusal([&] { tracker.select(region); });
}

}  // namespace

TEST(ObjectTracker, followsAnObjectThatMovesRotatesAndGrows)
{
  ObjectTracker tracker = selected();
  TrackedObject found;
  for (int frame = 1; frame <= 60; ++frame)
  {
    const double t = frame * kPeriod;
    const cv::Point2d center = kStart + cv::Point2d(30.0 * t, 10.0 * t);
    const double scale = 1.0 + 0.4 * t, angle = 0.6 * t;
    found = tracker.update(t, with(kObject, center, scale, angle), "bgr8").at(0);
    ASSERT_TRUE(found.tracked) << frame;
    EXPECT_LT(distance(found.center, center), 1.0) << frame;
    EXPECT_NEAR(found.scale, scale, 0.02) << frame;
    EXPECT_NEAR(found.angle, angle, 0.02) << frame;
  }
  EXPECT_EQ(found.id, 1);
  EXPECT_EQ(found.label, "thing");
  EXPECT_LT(distance(found.velocity, {30.0, 10.0}), 3.0);
  EXPECT_GT(found.confidence, 0.6);
  EXPECT_GT(found.points.size(), 10U);
  const double c = 1.8 * std::cos(1.2), s = 1.8 * std::sin(1.2);  // in the last frame, after 2 s
  EXPECT_LT(distance(found.outline[0], found.center + cv::Point2d(-30.0 * c + 25.0 * s, -30.0 * s - 25.0 * c)), 2.0);
  EXPECT_LT(distance(found.outline[2], found.center - cv::Point2d(-30.0 * c + 25.0 * s, -30.0 * s - 25.0 * c)), 2.0);
}

TEST(ObjectTracker, followsSeveralObjects)
{
  ObjectTracker tracker;
  const cv::Mat other = blots({50, 50}, 4);
  const auto imageAt = [&](double t) {
    return with(other, {249.5 - 20.0 * t, 60.0}, 1.0, 0.0, with(kObject, {60.0 + 30.0 * t, 170.0}));
  };
  tracker.update(0.0, imageAt(0.0), "bgr8");
  EXPECT_EQ(tracker.select({31, 146, 60, 50}, "a"), 1);
  EXPECT_EQ(tracker.select({225, 36, 50, 50}, "b"), 2);
  for (double t = kPeriod; t < 2.0; t += kPeriod)
  {
    const std::vector<TrackedObject> found = tracker.update(t, imageAt(t), "bgr8");
    ASSERT_EQ(found.size(), 2U);
    EXPECT_TRUE(found[0].tracked && found[1].tracked);
    EXPECT_LT(distance(found[0].center, {60.5 + 30.0 * t, 170.5}), 1.5);
    EXPECT_LT(distance(found[1].center, {249.5 - 20.0 * t, 60.5}), 1.5);
  }
  EXPECT_TRUE(tracker.forget(1));
  EXPECT_FALSE(tracker.forget(1));
  ASSERT_EQ(tracker.objects().size(), 1U);
  EXPECT_EQ(tracker.objects()[0].label, "b");
  tracker.clear();
  EXPECT_TRUE(tracker.update(3.0, imageAt(0.0), "bgr8").empty());
}

TEST(ObjectTracker, followsLongAndLargeRegions)
{
  const cv::Mat large = blots({400, 300}, 7);
  for (const cv::Rect& region : {cv::Rect(20, 100, 280, 16), cv::Rect(150, 20, 17, 200), cv::Rect(10, 10, 301, 223)})
  {
    ObjectTracker tracker;
    tracker.update(0.0, large(cv::Rect({40, 30}, kImageSize)), "bgr8");
    tracker.select(region);
    TrackedObject found;
    for (int frame = 1; frame <= 8; ++frame)
      found = tracker.update(frame * kPeriod, large(cv::Rect({40 - frame, 30 + frame}, kImageSize)), "bgr8").at(0);
    EXPECT_TRUE(found.tracked) << region;
    const cv::Point2d corner(region.x - 0.5 + 8.0, region.y - 0.5 - 8.0);
    EXPECT_LT(distance(found.outline[0], corner), 0.5) << region;
    EXPECT_LT(distance(found.outline[2], corner + cv::Point2d(region.width, region.height)), 0.5) << region;
  }
}

TEST(ObjectTracker, followsAJumpByFlowAlone)
{
  ObjectTrackerParams params;
  params.search_period = 3600.0;
  ObjectTracker tracker = selected(params);
  const cv::Point2d there = kStart + cv::Point2d(24.0, -14.0);
  const TrackedObject found = tracker.update(kPeriod, with(kObject, there), "bgr8").at(0);
  EXPECT_TRUE(found.tracked);
  EXPECT_LT(distance(found.center, there), 1.0);
}

TEST(ObjectTracker, followsSmallRegions)
{
  for (const int side : {16, 20, 24})
  {
    int chosen = 0;
    for (int seed = 0; seed < 20; ++seed)
    {
      const cv::Mat patch = blots({side, side}, 100 + seed);
      const cv::Point2d place(100.0 + 0.5 * (side - 1), 80.0 + 0.5 * (side - 1)), moved = place + cv::Point2d(3.0, 2.0);
      ObjectTracker tracker;
      tracker.update(0.0, with(patch, place), "bgr8");
      if (!refusal([&] { tracker.select(cv::Rect(100, 80, side, side)); }).empty()) continue;
      ++chosen;
      const TrackedObject found = tracker.update(kPeriod, with(patch, moved), "bgr8").at(0);
      if (found.tracked) EXPECT_LT(distance(found.center, moved), 1.0);
    }
    EXPECT_GE(chosen, side < 20 ? 5 : 10) << side;  // the others have too few distinct points
  }
}

TEST(ObjectTracker, givesTheSameResultsForTheSameFrames)
{
  ObjectTracker a = selected(), b = selected();
  for (int frame = 1; frame < 30; ++frame)
  {
    const cv::Mat image = frame % 10 < 3 ? kBackground : with(kObject, kStart + cv::Point2d(2.0 * frame, 0.0));
    const TrackedObject one = a.update(frame * kPeriod, image, "bgr8").at(0);
    const TrackedObject other = b.update(frame * kPeriod, image, "bgr8").at(0);
    EXPECT_EQ(one.tracked, other.tracked);
    EXPECT_EQ(one.outline, other.outline);
    EXPECT_EQ(one.points, other.points);
    cv::theRNG().state = static_cast<std::uint64_t>(frame);
  }
}

TEST(ObjectTracker, namesWhatIsWrongWithASelection)
{
  EXPECT_EQ(refusalOf(kRegion), "");
  EXPECT_EQ(refusalOf({300, 0, 30, 30}), "region of 30x30 px at (300, 0) is not inside the image of 320x240");
  EXPECT_EQ(refusalOf({-1, 0, 30, 30}), "region of 30x30 px at (-1, 0) is not inside the image of 320x240");
  EXPECT_EQ(refusalOf({1 << 30, 0, 1 << 30, 30}).find("region of 1073741824x30 px at (1073741824, 0) is not"), 0U);
  EXPECT_EQ(refusalOf({10, 10, 15, 50}),
            "region of 15x50 px at (10, 10) is too small, must be at least 16x16 px inside the image of 320x240");
  ObjectTracker tracker;
  EXPECT_EQ(refusal([&] { tracker.select(kRegion); }), "there is no image yet to select a region of");
  cv::Mat wall = cv::Mat(kImageSize, CV_8UC1, cv::Scalar(128)), grain(kImageSize, CV_8SC1);
  cv::RNG(1).fill(grain, cv::RNG::NORMAL, 0.0, 5.0);
  cv::add(wall, grain, wall, cv::noArray(), CV_8U);
  for (const cv::Mat& image : {wall, cv::Mat(kImageSize, CV_8UC1, cv::Scalar(128))})
  {
    tracker.update(0.0, image, "mono8");
    EXPECT_EQ(refusal([&] { tracker.select(kRegion); }),
              "region of 60x50 px at (130, 95) has 0 feature points, must have at least 8: select something with a "
              "pattern");
  }
  EXPECT_TRUE(tracker.objects().empty());
  EXPECT_THROW(tracker.update(1.0, cv::Mat(), "mono8"), std::invalid_argument);
}

TEST(ObjectTracker, refusesParametersOutOfRange)
{
  ObjectTrackerParams params;
  params.levels = 9;
  EXPECT_THROW(ObjectTracker{params}, std::invalid_argument);
  ObjectTracker tracker;
  EXPECT_THROW(tracker.configure(params), std::invalid_argument);
}

TEST(ObjectTracker, doesNotLoseAnObjectWhenTheLightChanges)
{
  const auto at = [](int frame) { return cv::Point2d(44.5 + 7.5 * frame, 119.5); };
  for (const bool brighter : {false, true})
    for (int seed = 0; seed < 3; ++seed)
    {
      const cv::Mat object = blots({80, 70}, seed);
      ObjectTracker tracker = selected({}, object, at(0));
      for (int frame = 1; frame <= 25; ++frame)
      {
        cv::Mat image = with(object, at(frame));
        // Flow fails between the two lights, so that the object can only be predicted by its velocity.
        if (frame % 2 == 1) image.convertTo(image, -1, brighter ? 2.0 : 0.5, brighter ? -100.0 : 0.0);
        const TrackedObject found = tracker.update(frame * kPeriod, image, "bgr8").at(0);
        ASSERT_TRUE(found.tracked) << frame;
        EXPECT_LT(distance(found.center, at(frame)), 1.0) << frame;
        EXPECT_GT(found.velocity.x, 0.0) << frame;  // even in the first frame, in which it is found by its features
      }
    }
}

TEST(ObjectTracker, followsAnObjectThatRotatesFast)
{
  for (int seed = 40; seed < 43; ++seed)
  {
    const cv::Mat object = blots({100, 90}, seed);
    ObjectTracker tracker = selected({}, object);
    for (int frame = 1; frame <= 20; ++frame)
    {
      const double angle = 0.3 * frame;
      const TrackedObject found = tracker.update(frame * kPeriod, with(object, kStart, 1.0, angle), "bgr8").at(0);
      EXPECT_TRUE(found.tracked) << frame;
      EXPECT_NEAR(std::remainder(found.angle - angle, 2.0 * CV_PI), 0.0, 0.02) << frame;
    }
  }
}

TEST(ObjectTracker, followsAnObjectOfWhichAThirdIsCovered)
{
  for (int seed = 50; seed < 54; ++seed)
  {
    const cv::Mat object = blots({80, 70}, seed);
    const cv::Rect region(120, 85, 80, 70);
    ObjectTracker tracker = selected({}, object);
    for (int covered = 2; covered <= 30; covered += 2)
    {
      cv::Mat image = with(object, kStart);
      image(cv::Rect(region.tl(), cv::Size(covered, region.height))).setTo(cv::Scalar::all(90));
      const TrackedObject found = tracker.update(covered * kPeriod, image, "bgr8").at(0);
      EXPECT_TRUE(found.tracked) << covered;
      EXPECT_LT(distance(found.center, kStart), 0.7) << covered;
    }
  }
}

TEST(ObjectTracker, followsAnObjectThatIsTooFastForFlowByItsVelocity)
{
  ObjectTrackerParams params;
  params.search_period = 3600.0;
  params.levels = 1;
  const auto at = [](int frame) { return cv::Point2d(34.5 + frame * frame, 119.5); };
  ObjectTracker tracker = selected(params, kObject, at(0));
  for (int frame = 1; frame <= 15; ++frame)
  {
    const TrackedObject found = tracker.update(frame * kPeriod, with(kObject, at(frame)), "bgr8").at(0);
    ASSERT_TRUE(found.tracked) << frame;
    EXPECT_LT(distance(found.center, at(frame)), 1.0) << frame;
  }
}

TEST(ObjectTracker, followsAnObjectThatLeavesTheImageUntilItIsHalfOutside)
{
  for (int seed = 30; seed < 34; ++seed)
  {
    const cv::Mat object = blots({80, 70}, seed);
    ObjectTracker tracker = selected({}, object, {79.5, 119.5});
    TrackedObject found;
    for (int frame = 1; frame < 50; ++frame)
    {
      const double x = 79.5 - 3.0 * frame;
      found = tracker.update(frame * kPeriod, with(object, {x, 119.5}), "bgr8").at(0);
      if (x > 8.0) EXPECT_TRUE(found.tracked) << x;  // 60 % of it are in the image
      if (found.tracked) EXPECT_LT(distance(found.center, {x, 119.5}), 2.0) << x;
    }
    EXPECT_FALSE(found.tracked);
  }
}

TEST(ObjectTracker, seesNoPointsOutsideOfTheImage)
{
  for (int seed = 0; seed < 6; ++seed)
  {
    cv::Mat label(160, 180, CV_8UC3, cv::Scalar::all(3));  // almost as black as the pixels outside of the image
    cv::RNG random(static_cast<std::uint64_t>(seed + 1));
    for (int y = 8; y < 140; y += 38)
      for (int x = 8; x < 160; x += 38)
        cv::rectangle(
            label,
            {x + random.uniform(0, 14), y + random.uniform(0, 14), random.uniform(12, 24), random.uniform(12, 24)},
            cv::Scalar::all(random.uniform(150, 250)), cv::FILLED);
    ObjectTracker tracker = selected({}, label, {219.5, 119.5});
    std::size_t seen = 0;
    for (int frame = 1; frame < 40; ++frame)
    {
      const cv::Mat image = with(label, {219.5 + 3.0 * frame, 119.5});
      const TrackedObject found = tracker.update(frame * kPeriod, image, "bgr8").at(0);
      for (const cv::Point2f& point : found.points)
        EXPECT_LT(point.x, 320.0F) << frame;
      seen += found.points.size();
    }
    EXPECT_GT(seen, 0U) << seed;
  }
}
