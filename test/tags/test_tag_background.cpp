// Searches of whole images in the background, and searches in several threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "core/tags/detection/tag_searches.hpp"
#include "robot_vision/tags/detection/tag_detector.hpp"
#include "support/found_tags.hpp"
#include "support/images.hpp"
#include "support/no_threads.hpp"
#include "support/refusal.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

constexpr double kStep = 1.0 / 30.0;  // s
constexpr int kMaxFrames = 300;       // within which a tag must be found
constexpr int kSearchFrames = 2;      // the most that a search in the background takes
constexpr const char* kFamily = "tag36h11";

/// The times of a stream's frames. The stream waits for searches, so that slow machines give the same results.
class Stream
{
public:
  explicit Stream(const TagDetector& detector, double start = 0.0) : detector_(detector), start_(start) {}

  /// The time of the next frame, s.
  double next()
  {
    if (frame_ == kMaxFrames) throw std::runtime_error("no tag found in all frames");
    if (frame_ % kSearchFrames == 0) detector_.waitForSearch();
    return start_ + frame_++ * kStep;
  }

private:
  const TagDetector& detector_;
  double start_;
  int frame_ = 0;
};

TagDetectorParams withBackgroundSearch(double period = 0.5, double decimate = 0.0)
{
  TagDetectorParams params;
  params.background = true;
  params.max_search_period = period;
  params.decimate = decimate;
  return params;
}

cv::Mat withTag(cv::Point2d middle, double side = 50.0, cv::Size size = {640, 480})
{
  cv::Mat gray = grayWall(size);
  drawTag(gray, kFamily, 5, tagCorners(middle, side, 0.3));
  return gray;
}

/// Draws tags of all sizes, some of which may be cut off or overlap.
cv::Mat randomScene(cv::RNG& random, int tags)
{
  cv::Mat gray = grayWall({800, 600});
  for (int i = 0; i < tags; ++i)
    drawTag(gray, kFamily, random.uniform(0, 587),
            tagCorners({random.uniform(0.0, 800.0), random.uniform(0.0, 600.0)}, random.uniform(15.0, 120.0),
                       random.uniform(0.0, 6.0), random.uniform(0.0, 0.8), random.uniform(0.0, 6.0)));
  photograph(gray, random);
  return gray;
}

cv::Mat encoded(const cv::Mat& gray, const std::string& encoding)
{
  cv::Mat image = gray;
  if (encoding == "bgr8") cv::cvtColor(gray, image, cv::COLOR_GRAY2BGR);
  if (encoding != "jpeg") return image;
  std::vector<uchar> bytes;
  cv::imencode(".jpg", gray, bytes);
  return cv::Mat(bytes, true).reshape(1, 1);
}

bool contains(const std::vector<Tag>& tags, const std::vector<Tag>& expected)
{
  const std::vector<int> ids = idsOf(tags), wanted = idsOf(expected);
  return std::includes(ids.begin(), ids.end(), wanted.begin(), wanted.end());
}

cv::Mat moved(const cv::Mat& gray, cv::Point2d way)
{
  cv::Mat result;
  cv::warpAffine(gray, result, cv::Matx23d(1.0, 0.0, way.x, 0.0, 1.0, way.y), gray.size(), cv::INTER_LINEAR,
                 cv::BORDER_REPLICATE);
  return result;
}

}  // namespace

TEST(TagBackground, theFirstFrameIsSearchedAtOnce)
{
  TagDetector detector(withBackgroundSearch(60.0));
  const cv::Mat gray = withTag({200.0, 200.0});
  EXPECT_EQ(idsOf(detector.update(10.0, gray, "mono8")), std::vector<int>{5});
  EXPECT_EQ(idsOf(detector.update(10.1, withTag({100.0, 100.0}, 40.0, {320, 240}), "mono8")), std::vector<int>{5});
  EXPECT_EQ(idsOf(detector.update(10.2, gray, "mono8")), std::vector<int>{5});
  EXPECT_EQ(idsOf(detector.update(3.0, withTag({500.0, 100.0}), "mono8")), std::vector<int>{5});
}

TEST(TagBackground, everyFrameIsSearchedIfThePeriodIsZero)
{
  TagDetector detector(withBackgroundSearch(0.0));
  for (int frame = 0; frame < 10; ++frame)
    EXPECT_EQ(detector.update(frame * kStep, withTag({60.0 + 55.0 * frame, 200.0}), "mono8").size(), 1U) << frame;
}

TEST(TagBackground, aNewTagIsReportedWhereItIsInTheNewestFrame)
{
  for (const double decimate : {0.0, 1.0})
    for (const double side : {30.0, 90.0})
    {
      TagDetector detector(withBackgroundSearch(0.5, decimate));
      Stream stream(detector);
      detector.update(stream.next(), grayWall({1280, 960}), "mono8");
      for (int seen = 0; seen < 5;)
      {
        const double time = stream.next();
        const cv::Point2d middle(640.0 + 400.0 * std::sin(time), 480.0 + 300.0 * std::cos(1.3 * time));
        const std::vector<Tag> tags = detector.update(time, withTag(middle, side, {1280, 960}), "mono8");
        ASSERT_LE(tags.size(), 1U);
        for (const Tag& tag : tags)
          EXPECT_LT(distance(tag.corners, tagCorners(middle, side, 0.3)), 0.5) << time;
        seen = tags.empty() ? 0 : seen + 1;
      }
    }
}

TEST(TagBackground, aLostTagIsFoundElsewhere)
{
  TagDetector detector(withBackgroundSearch());
  Stream stream(detector);
  for (int frame = 0; frame < 20; ++frame)
    ASSERT_EQ(detector.update(stream.next(), withTag({100.0, 200.0}, 30.0), "mono8").size(), 1U);
  const cv::Mat elsewhere = withTag({500.0, 300.0}, 30.0);
  while (detector.update(stream.next(), elsewhere, "mono8").empty())
    ;
}

TEST(TagBackground, aTagThatHasLeftIsNotReported)
{
  TagDetector detector(withBackgroundSearch(60.0));
  detector.update(0.0, grayWall({640, 480}), "mono8");
  EXPECT_TRUE(detector.update(100.0, withTag({300.0, 200.0}), "mono8").empty());  // starts a search
  Stream stream(detector, 100.1);
  for (int frame = 0; frame < 30; ++frame)
    EXPECT_TRUE(detector.update(stream.next(), grayWall({640, 480}), "mono8").empty());
}

TEST(TagBackground, aNewTagIsLookedForAroundItsPlace)
{
  TagDetector detector(withBackgroundSearch(60.0, 1.0));
  detector.update(0.0, grayWall({640, 480}), "mono8");
  EXPECT_TRUE(detector.update(100.0, withTag({300.0, 200.0}), "mono8").empty());  // starts the only search
  Stream stream(detector, 100.1);
  const cv::Mat beside = withTag({350.0, 200.0});
  while (detector.update(stream.next(), beside, "mono8").empty())
    ;
}

TEST(TagBackground, theCallerMayReuseItsMemory)
{
  for (const std::string encoding : {"mono8", "bgr8", "jpeg"})
  {
    TagDetector detector(withBackgroundSearch(60.0, 1.0));
    const cv::Mat wall = encoded(grayWall({1280, 960}), encoding);
    const cv::Mat shown = encoded(withTag({300.0, 200.0}, 50.0, {1280, 960}), encoding);
    detector.update(0.0, wall, encoding);
    cv::Mat frame = shown.clone();
    EXPECT_TRUE(detector.update(100.0, frame, encoding).empty());  // starts the only search
    frame.setTo(128);
    // The detector does not use the memory of the running search for the next frames, either.
    for (int i = 1; i <= 3; ++i)
      EXPECT_TRUE(detector.update(100.0 + 0.001 * i, wall, encoding).empty());
    Stream stream(detector, 100.1);
    while (detector.update(stream.next(), shown, encoding).empty())
      ;
  }
}

TEST(TagBackground, theFrameIsSearchedAtOnceIfNoThreadStarts)
{
  TagDetector detector(withBackgroundSearch(60.0, 1.0));
  detector.update(0.0, grayWall({640, 480}), "mono8");
  {
    const NoThreads none;
    EXPECT_EQ(idsOf(detector.update(100.0, withTag({300.0, 200.0}), "mono8")), std::vector<int>{5});
    EXPECT_TRUE(detector.lacksThreads());
  }
  EXPECT_TRUE(detector.update(300.0, withTag({500.0, 300.0}), "mono8").empty());  // starts a search
  EXPECT_FALSE(detector.lacksThreads());
}

TEST(TagBackground, anAbandonedSearchIsNotWaitedFor)
{
  const auto threads = []
  {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  const cv::Mat large = withTag({1700.0, 900.0}, 60.0, {3840, 2160});
  for (const bool abandon : {false, true})
  {
    auto detector = std::make_unique<TagDetector>(withBackgroundSearch());
    detector->update(0.0, grayWall(large.size()), "mono8");
    const auto before = threads();
    detector->update(10.0, large, "mono8");  // starts a search
    EXPECT_EQ(threads(), before + 1);
    if (abandon) detector->abandonSearch();
    detector.reset();
    if (abandon) EXPECT_EQ(threads(), before + 1);
    while (threads() > before)  // the kernel may still list a thread that has been joined
      std::this_thread::yield();
  }
}

TEST(TagBackground, allTagsOfAFullSearchAreFound)
{
  cv::RNG random(21);
  TagDetector reference;
  for (int tags = 0; tags <= 40; tags += 4)
  {
    const cv::Mat gray = randomScene(random, tags);
    const std::vector<Tag> expected = reference.detect(gray, "mono8");
    TagDetector detector(withBackgroundSearch(kStep));  // less than a search takes
    Stream stream(detector);
    EXPECT_TRUE(detector.update(stream.next(), grayWall(gray.size()), "mono8").empty());
    // The search around a tag may find more tags than that of the whole image.
    while (!contains(detector.update(stream.next(), gray, "mono8"), expected))
      ;
  }
}

TEST(TagBackground, parametersMayChangeDuringASearch)
{
  cv::RNG random(22);
  cv::Mat gray = grayWall({1280, 960});
  drawTag(gray, "tag36h11", 5, tagCorners({300.0, 300.0}, 30.0));
  drawTag(gray, "tag25h9", 6, tagCorners({700.0, 600.0}, 30.0));
  addNoise(gray, 3.0, random);
  TagDetector detector(withBackgroundSearch());
  detector.update(0.0, grayWall(gray.size()), "mono8");
  double time = 0.0;
  for (int change = 0; change < 6; ++change)
  {
    const std::string family = change % 2 == 0 ? "tag36h11" : "tag25h9";
    TagDetectorParams params = withBackgroundSearch();
    params.families = {family};
    detector.configure(params);
    detector.update(time += 100.0, gray, "mono8");  // starts a search
    if (change < 4) continue;                       // the next change makes that search's parameters outdated
    Stream stream(detector, time + kStep);
    for (std::vector<Tag> tags; tags.empty();)
    {
      tags = detector.update(time = stream.next(), gray, "mono8");
      for (const Tag& tag : tags)
        EXPECT_EQ(tag.family, family);
    }
  }
}

TEST(TagBackground, theSizeMayChangeDuringASearch)
{
  TagDetector detector(withBackgroundSearch());
  const cv::Mat large = withTag({1700.0, 900.0}, 60.0, {1920, 1080});
  const cv::Mat small = withTag({60.0, 60.0}, 50.0, {320, 240});
  detector.update(0.0, grayWall(large.size()), "mono8");
  for (int i = 1; i < 4; ++i)
  {
    detector.update(10.0 * i, large, "mono8");  // starts a search
    for (int frame = 1; frame < 10; ++frame)
      EXPECT_EQ(detector.update(10.0 * i + frame * kStep, small, "mono8").size(), 1U);
    EXPECT_EQ(detector.update(10.0 * i + 1.0, large, "mono8").size(), 1U);
  }
}

TEST(TagBackground, theErrorOfADroppedSearchIsDropped)
{
  const cv::Mat gray = withTag({300.0, 200.0});
  const double absurd = 1e7;  // decimation with which a search throws
  TagSearches searches(withBackgroundSearch());
  ASSERT_TRUE(searches.start(gray, absurd));
  searches.drop();
  searches.wait();
  EXPECT_FALSE(searches.take());
  EXPECT_FALSE(searches.busy());
  ASSERT_TRUE(searches.start(gray, absurd));
  searches.wait();
  EXPECT_THROW(searches.take(), cv::Exception);
  EXPECT_FALSE(searches.busy());
}

TEST(TagBackground, aRefusedImageIsReleased)
{
  const cv::Mat wide = grayWall({8193, 16});
  TagDetector detector(withBackgroundSearch());
  EXPECT_NE(refusal([&] { detector.update(0.0, wide, "mono8"); }), "");
  EXPECT_NE(refusal([&] { detector.detect(wide, "mono8"); }), "");
  EXPECT_EQ(wide.u->refcount, 1);
}

TEST(TagBackground, aDetectorMayBeMovedOrDestroyedDuringASearch)
{
  for (int i = 0; i < 5; ++i)
  {
    TagDetector detector(withBackgroundSearch());
    detector.update(0.0, grayWall({1280, 960}), "mono8");
    detector.update(10.0, withTag({300.0, 200.0}, 50.0, {1280, 960}), "mono8");  // starts a search
    TagDetector other(std::move(detector));
    EXPECT_EQ(other.detect(withTag({300.0, 200.0}), "mono8").size(), 1U);
  }
}

TEST(TagThreads, theirNumberDoesNotChangeTheResults)
{
  constexpr std::size_t kFrames = 6;  // the first is searched whole, all around tags, and one coarsely
  cv::RNG random(23);
  std::vector<cv::Mat> images;
  for (int tags = 0; tags <= 40; tags += 10)
  {
    const cv::Mat gray = randomScene(random, tags);
    const cv::Point2d way(random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0));
    for (std::size_t frame = 0; frame < kFrames; ++frame)
      images.push_back(moved(gray, way * static_cast<double>(frame)));
  }
  std::vector<std::vector<Tag>> expected;
  for (const int threads : {1, 2, 3, 16})  // each once, as OpenCV takes a while to end and start its threads
  {
    const ThreadCount count(threads);
    std::optional<TagDetector> detector;
    for (std::size_t i = 0; i < images.size(); ++i)
    {
      if (i % kFrames == 0) detector.emplace();
      const std::vector<Tag> found = detector->update(static_cast<double>(i % kFrames) * kStep, images[i], "mono8");
      if (threads == 1) expected.push_back(found);
      EXPECT_EQ(difference(expected[i], found), 0.0) << i << " " << threads;
    }
  }
}
