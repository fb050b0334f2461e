#include "robot_vision/object_tracker.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "pictures.hpp"
#include "refusal.hpp"

using namespace robot_vision;

namespace
{

const cv::Size kPicture(320, 240);
constexpr double kPeriod = 1.0 / 30.0;  // s

/// Blots of all sizes, as photographs have them; the same for the same seed.
cv::Mat blots(const cv::Size& size, int seed)
{
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat picture(size, CV_8UC3, cv::Scalar::all(128));
  for (int i = 0; i < size.area() / 60; ++i)
  {
    const cv::Point at(random.uniform(0, size.width), random.uniform(0, size.height));
    const cv::Scalar color(random.uniform(0, 256), random.uniform(0, 256), random.uniform(0, 256));
    cv::circle(picture, at, random.uniform(1, 9), color, cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

const cv::Mat kBackground = blots(kPicture, 1);

/// The background with a picture before it, whose middle is at `center`, turned (rad, clockwise) and scaled.
cv::Mat with(const cv::Mat& object, const cv::Point2d& center, double scale = 1.0, double angle = 0.0,
             const cv::Mat& background = kBackground)
{
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  const double x = 0.5 * (object.cols - 1), y = 0.5 * (object.rows - 1);
  const cv::Matx23d place(c, -s, center.x - c * x + s * y, s, c, center.y - s * x - c * y);
  cv::Mat picture = background.clone();
  cv::warpAffine(object, picture, place, picture.size(), cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  return picture;
}

const cv::Mat kObject = blots({60, 50}, 2);
const cv::Point2d kStart(159.5, 119.5);
const cv::Rect kRegion(130, 95, 60, 50);  // where it is then

/// A tracker that has selected the object in the frame of time 0.
ObjectTracker selected(const ObjectTrackerParams& params = ObjectTrackerParams())
{
  ObjectTracker tracker(params);
  tracker.update(0.0, with(kObject, kStart), "bgr8");
  EXPECT_EQ(tracker.select(kRegion, "thing"), 1);
  return tracker;
}

std::string refusalOf(const cv::Rect& region)
{
  ObjectTracker tracker;
  tracker.update(0.0, with(kObject, kStart), "bgr8");
  return refusal([&] { tracker.select(region); });
}

double distance(const cv::Point2d& a, const cv::Point2d& b)
{
  return cv::norm(a - b);
}

}  // namespace

TEST(ObjectTracker, followsWhatMovesTurnsAndGrows)
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
  const double c = 1.8 * std::cos(1.2), s = 1.8 * std::sin(1.2);  // at the last frame, of 2 s
  EXPECT_LT(distance(found.outline[0], found.center + cv::Point2d(-30.0 * c + 25.0 * s, -30.0 * s - 25.0 * c)), 2.0);
  EXPECT_LT(distance(found.outline[2], found.center - cv::Point2d(-30.0 * c + 25.0 * s, -30.0 * s - 25.0 * c)), 2.0);
}

TEST(ObjectTracker, saysThatItIsLostAndFindsItElsewhere)
{
  ObjectTracker tracker = selected();
  for (int frame = 1; frame < 30; ++frame)
  {
    const TrackedObject lost = tracker.update(frame * kPeriod, kBackground, "bgr8").at(0);
    EXPECT_FALSE(lost.tracked);
    EXPECT_EQ(lost.confidence, 0.0);
    EXPECT_TRUE(lost.points.empty());
    EXPECT_LT(distance(lost.center, kStart), 1.0);  // where it was
  }
  const cv::Point2d center(80.0, 170.0);
  int missed = 0;
  while (!tracker.update(1.0 + missed * kPeriod, with(kObject, center, 1.3, 0.8), "bgr8").at(0).tracked)
    ASSERT_LT(++missed, 30);  // a second
  const TrackedObject found = tracker.objects().at(0);
  EXPECT_LT(distance(found.center, center), 1.0);
  EXPECT_NEAR(found.scale, 1.3, 0.02);
  EXPECT_NEAR(found.angle, 0.8, 0.02);
}

TEST(ObjectTracker, isNotDrawnAwayByWhatCoversIt)
{
  ObjectTracker tracker = selected();
  const cv::Mat cover = blots({120, 120}, 3);
  bool lost = false;
  for (int frame = 1; frame < 60; ++frame)
  {
    const cv::Mat picture = with(cover, {10.0 + 5.0 * frame, 120.0}, 1.0, 0.0, with(kObject, kStart));
    const TrackedObject found = tracker.update(frame * kPeriod, picture, "bgr8").at(0);
    lost |= !found.tracked;
    if (found.tracked) EXPECT_LT(distance(found.center, kStart), 3.0) << frame;
  }
  EXPECT_TRUE(lost);
  EXPECT_TRUE(tracker.objects().at(0).tracked);
}

TEST(ObjectTracker, keepsSeveralApart)
{
  ObjectTracker tracker;
  const cv::Mat other = blots({50, 50}, 4);
  const auto picture = [&](double t) {
    return with(other, {249.5 - 20.0 * t, 60.0}, 1.0, 0.0, with(kObject, {60.0 + 30.0 * t, 170.0}));
  };
  tracker.update(0.0, picture(0.0), "bgr8");
  EXPECT_EQ(tracker.select({31, 146, 60, 50}, "a"), 1);
  EXPECT_EQ(tracker.select({225, 36, 50, 50}, "b"), 2);
  for (double t = kPeriod; t < 2.0; t += kPeriod)
  {
    const std::vector<TrackedObject> found = tracker.update(t, picture(t), "bgr8");
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
  EXPECT_TRUE(tracker.update(3.0, picture(0.0), "bgr8").empty());
}

TEST(ObjectTracker, followsLongAndLargeRegions)
{
  const cv::Mat large = blots({400, 300}, 7);
  for (const cv::Rect& region : {cv::Rect(20, 100, 280, 16), cv::Rect(150, 20, 17, 200), cv::Rect(10, 10, 301, 223)})
  {
    ObjectTracker tracker;
    tracker.update(0.0, large(cv::Rect({40, 30}, kPicture)), "bgr8");
    tracker.select(region);
    TrackedObject found;
    for (int frame = 1; frame <= 8; ++frame)
      found = tracker.update(frame * kPeriod, large(cv::Rect({40 - frame, 30 + frame}, kPicture)), "bgr8").at(0);
    EXPECT_TRUE(found.tracked) << region;
    const cv::Point2d corner(region.x - 0.5 + 8.0, region.y - 0.5 - 8.0);
    EXPECT_LT(distance(found.outline[0], corner), 0.5) << region;
    EXPECT_LT(distance(found.outline[2], corner + cv::Point2d(region.width, region.height)), 0.5) << region;
  }
}

TEST(ObjectTracker, findsNothingAgainWhereItIsFollowedAlready)
{
  ObjectTracker tracker = selected();
  EXPECT_EQ(tracker.select(with(kObject, kStart), "bgr8", kRegion, "thing"), 2);
  EXPECT_EQ(tracker.select(with(kObject, kStart), "bgr8", kRegion, "another name"), 3);
  const std::vector<TrackedObject> found = tracker.update(kPeriod, with(kObject, kStart), "bgr8");
  EXPECT_TRUE(found[0].tracked && !found[1].tracked && found[2].tracked);
}

TEST(ObjectTracker, selectsInAFrameOfThePast)
{
  ObjectTracker tracker;
  const cv::Mat past = with(kObject, kStart), before = past.clone();
  tracker.update(0.0, with(kObject, kStart + cv::Point2d(25.0, 0.0)), "bgr8");
  EXPECT_EQ(tracker.select(past, "bgr8", kRegion, "thing"), 1);
  EXPECT_FALSE(tracker.objects().at(0).tracked);
  const TrackedObject found = tracker.update(0.1, with(kObject, kStart + cv::Point2d(30.0, 0.0)), "bgr8").at(0);
  EXPECT_TRUE(found.tracked);
  EXPECT_LT(distance(found.center, kStart + cv::Point2d(30.0, 0.0)), 1.0);
  EXPECT_TRUE(equal(past, before));
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

TEST(ObjectTracker, searchesTheWholePictureAtIntervals)
{
  ObjectTrackerParams params;
  params.search_period = 1.0;
  ObjectTracker tracker = selected(params);
  const cv::Mat elsewhere = with(kObject, {70.0, 60.0});
  EXPECT_FALSE(tracker.update(0.1, kBackground, "bgr8").at(0).tracked);  // searched, in vain
  for (const double time : {0.3, 0.6, 0.9})
    EXPECT_FALSE(tracker.update(time, elsewhere, "bgr8").at(0).tracked) << time;
  EXPECT_TRUE(tracker.update(1.2, elsewhere, "bgr8").at(0).tracked);
}

TEST(ObjectTracker, losesWhatIsHalfCoveredIfItMustBeSure)
{
  cv::Mat covered = with(kObject, kStart);
  covered(cv::Rect(kRegion.x, kRegion.y, kRegion.width / 2, kRegion.height)).setTo(cv::Scalar::all(90));
  ObjectTracker tracker = selected();
  EXPECT_TRUE(tracker.update(kPeriod, covered, "bgr8").at(0).tracked);
  ObjectTrackerParams params;
  params.min_confidence = 0.9;
  tracker.configure(params);
  EXPECT_FALSE(tracker.update(2.0 * kPeriod, covered, "bgr8").at(0).tracked);
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
    EXPECT_GE(chosen, side < 20 ? 5 : 10) << side;  // of the others too few points are distinct
  }
}

TEST(ObjectTracker, searchesAfterAJumpInTimeOrSize)
{
  ObjectTracker tracker = selected();
  const cv::Point2d elsewhere(70.0, 70.0);
  const TrackedObject back = tracker.update(-5.0, with(kObject, elsewhere), "bgr8").at(0);
  EXPECT_TRUE(back.tracked);
  EXPECT_LT(distance(back.center, elsewhere), 1.0);
  EXPECT_EQ(back.velocity, cv::Point2d());
  EXPECT_TRUE(tracker.flow().empty());
  cv::Mat background;
  cv::resize(kBackground, background, {640, 480});
  const cv::Mat larger = with(kObject, {400.0, 300.0}, 1.0, 0.0, background);
  const TrackedObject found = tracker.update(-4.7, larger, "bgr8").at(0);
  EXPECT_TRUE(found.tracked);
  EXPECT_LT(distance(found.center, {400.0, 300.0}), 1.0);
  double time = -9.0;  // going back, so that each is searched
  for (const cv::Size tiny : {cv::Size(1, 1), cv::Size(7, 10), cv::Size(16, 640), cv::Size(640, 17)})
    EXPECT_FALSE(tracker.update(time -= 1.0, noise(tiny, CV_8UC1), "mono8").at(0).tracked) << tiny;
  EXPECT_THROW(tracker.update(std::nan(""), larger, "bgr8"), std::invalid_argument);
}

TEST(ObjectTracker, isTheSameForTheSameFrames)
{
  ObjectTracker a = selected(), b = selected();
  for (int frame = 1; frame < 30; ++frame)
  {
    const cv::Mat picture = frame % 10 < 3 ? kBackground : with(kObject, kStart + cv::Point2d(2.0 * frame, 0.0));
    const TrackedObject one = a.update(frame * kPeriod, picture, "bgr8").at(0);
    const TrackedObject other = b.update(frame * kPeriod, picture, "bgr8").at(0);
    EXPECT_EQ(one.tracked, other.tracked);
    EXPECT_EQ(one.outline, other.outline);
    EXPECT_EQ(one.points, other.points);
    cv::theRNG().state = static_cast<std::uint64_t>(frame);
  }
}

TEST(ObjectTracker, measuresTheFlowOfTheWholePicture)
{
  ObjectTracker tracker;
  EXPECT_TRUE(tracker.flow().empty());
  const cv::Mat large = blots({340, 260}, 6);
  tracker.update(1.0, large(cv::Rect({10, 10}, kPicture)), "bgr8");
  EXPECT_TRUE(tracker.flow().empty());
  tracker.update(1.1, large(cv::Rect({7, 14}, kPicture)), "bgr8");  // all moves by 3 px right, 4 px up
  const std::vector<FlowPoint> flow = tracker.flow(100);
  EXPECT_GT(flow.size(), 60U);
  EXPECT_LE(flow.size(), 100U);
  std::size_t right = 0;
  for (const FlowPoint& point : flow)
    right += distance(point.velocity, {30.0, -40.0}) < 2.0;
  EXPECT_GE(static_cast<double>(right), 0.97 * static_cast<double>(flow.size()));
  EXPECT_THROW(tracker.flow(0), std::invalid_argument);
}

TEST(ObjectTracker, saysWhatIsWrongWithASelection)
{
  EXPECT_EQ(refusalOf(kRegion), "");
  EXPECT_EQ(refusalOf({300, 0, 30, 30}), "region of 30x30 px at (300, 0) is not inside the picture of 320x240");
  EXPECT_EQ(refusalOf({-1, 0, 30, 30}), "region of 30x30 px at (-1, 0) is not inside the picture of 320x240");
  EXPECT_EQ(refusalOf({1 << 30, 0, 1 << 30, 30}).find("region of 1073741824x30 px at (1073741824, 0) is not"), 0U);
  EXPECT_EQ(refusalOf({10, 10, 0, 0}),
            "region of 0x0 px at (10, 10) is too small, must be at least 16x16 px inside the picture of 320x240");
  ObjectTracker tracker;
  EXPECT_EQ(refusal([&] { tracker.select(kRegion); }), "there is no picture yet to select a region of");
  cv::Mat wall = cv::Mat(kPicture, CV_8UC1, cv::Scalar(128)), grain(kPicture, CV_8SC1);
  cv::RNG(1).fill(grain, cv::RNG::NORMAL, 0.0, 5.0);
  cv::add(wall, grain, wall, cv::noArray(), CV_8U);
  for (const cv::Mat& picture : {wall, cv::Mat(kPicture, CV_8UC1, cv::Scalar(128))})
  {
    tracker.update(0.0, picture, "mono8");
    EXPECT_EQ(refusal([&] { tracker.select(kRegion); }),
              "region of 60x50 px at (130, 95) has 0 feature points, must have at least 8: select something with a "
              "pattern");
  }
  EXPECT_TRUE(tracker.objects().empty());
  EXPECT_THROW(tracker.update(1.0, cv::Mat(), "mono8"), std::invalid_argument);
}

TEST(ObjectTracker, refusesWhatIsOutOfRange)
{
  const auto refused = [](auto change)
  {
    ObjectTrackerParams params;
    change(params);
    return refusal([&] { validate(params); });
  };
  EXPECT_EQ(refused([](ObjectTrackerParams&) {}), "");
  EXPECT_EQ(refused([](ObjectTrackerParams& p) { p.points = 7; }), "points is 7, must be from 8 to 200");
  EXPECT_EQ(refused([](ObjectTrackerParams& p) { p.window = 8; }), "window is 8, must be odd and from 5 to 51");
  EXPECT_EQ(refused([](ObjectTrackerParams& p) { p.min_confidence = 0.0; }),
            "min_confidence is 0, must be from 0.05 to 1");
  EXPECT_EQ(refused([](ObjectTrackerParams& p) { p.search_period = -1.0; }),
            "search_period is -1, must be from 0 to 3600");
  ObjectTrackerParams params;
  params.levels = 9;
  EXPECT_THROW(ObjectTracker{params}, std::invalid_argument);
  ObjectTracker tracker;
  EXPECT_THROW(tracker.configure(params), std::invalid_argument);
}
