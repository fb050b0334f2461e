#include "robot_vision/tags/detection/tag_detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "support/found_tags.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr double kStep = 1.0 / 30.0;  // s
constexpr const char* kFamily = "tag36h11";

double median(std::vector<double> values)
{
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Draws tags of one family in rows, each with another rotation and tilt. The ids are spread over the family.
std::map<int, TagCorners> drawRows(cv::Mat& gray, const std::string& family, double side, int count)
{
  std::map<int, TagCorners> truth;
  const int ids = tagFamily(family).ids;
  const double cells = static_cast<double>(tagFamily(family).width + 2) / tagFamily(family).width_at_border;
  const int field = cvCeil(side * cells * 1.45);
  const int columns = gray.cols / field;
  for (int i = 0; i < count; ++i)
  {
    const cv::Point2d middle((i % columns + 0.5) * field + 0.31 * i - std::floor(0.31 * i),
                             (i / columns + 0.5) * field);
    const int id = static_cast<int>(static_cast<long>(i) * (ids - 1) / std::max(count - 1, 1));
    truth[id] = tagCorners(middle, side, 0.7 * i, 0.11 * (i % 8), 0.9 * i);
    drawTag(gray, family, id, truth[id]);
  }
  return truth;
}

std::string refusalOf(const std::function<void(TagDetectorParams&)>& change)
{
  return refusal([&change] { TagDetector detector(with(change)); });
}

constexpr int kLeavingTag = 400;

/// Tags that move: they turn, come nearer and follow curves, and one leaves the image and comes back.
std::map<int, TagCorners> movingTags(int frame, cv::Size size)
{
  const double t = frame * kStep;
  const cv::Point2d middle(size.width / 2.0 + 40.0, size.height / 2.0);
  return {
      {7, tagCorners(middle + cv::Point2d(100.0 * std::sin(2.5 * t), 60.0 * std::sin(3.5 * t)), 60.0, t, 0.5, 2.0 * t)},
      {100, tagCorners({90.0, 90.0}, 60.0 + 25.0 * std::sin(4.0 * t), 0.3 * t, 0.7 * std::sin(t), 1.0)},
      {250, tagCorners({size.width - 60.0, 60.0 + 30.0 * std::sin(9.0 * t)}, 30.0, 0.2, 0.3, t)},
      {kLeavingTag,
       tagCorners({size.width / 2.0 + (size.width / 2.0 + 60.0) * std::sin(1.3 * t), size.height - 50.0}, 50.0, 0.1)},
  };
}

cv::Mat drawMoving(int frame, cv::Size size, std::map<int, TagCorners>& truth)
{
  cv::Mat gray = grayWall(size);
  cv::RNG random(static_cast<std::uint64_t>(frame) + 1);
  truth = movingTags(frame, size);
  for (const auto& tag : truth)
    drawTag(gray, kFamily, tag.first, tag.second);
  photograph(gray, random);
  return gray;
}

}  // namespace

TEST(TagDetector, findsEveryFamilyToAFractionOfAPixel)
{
  cv::RNG random(3);
  for (const TagFamily& family : tagFamilies())
  {
    TagDetector detector(with([&](TagDetectorParams& p) { p.families = {family.name}; }));
    for (const double side : {30.0, 80.0})
    {
      cv::Mat gray = grayWall({1280, cvRound(12.0 * side)});  // high enough for the rows of every family
      const auto truth = drawRows(gray, family.name, side, 12);
      photograph(gray, random);
      const std::vector<Tag> tags = detector.detect(gray, "mono8");
      ASSERT_EQ(tags.size(), truth.size()) << family.name << side;
      std::vector<double> errors;
      for (const Tag& tag : tags)
      {
        ASSERT_EQ(truth.count(tag.id), 1U) << family.name << tag.id;
        EXPECT_EQ(tag.family, family.name);
        EXPECT_EQ(tag.hamming, 0);
        EXPECT_GT(tag.similarity, 0.93) << family.name << side;
        EXPECT_GT(tag.margin, 50.0);
        errors.push_back(distance(tag.corners, truth.at(tag.id)));
        EXPECT_LT(cv::norm(tag.center - cv::Point2d(tag.corners[0] + tag.corners[2]) / 2.0), 0.1 * side);
      }
      EXPECT_LT(median(errors), 0.2) << family.name << side;
      EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.6) << family.name << side;
    }
  }
}

TEST(TagDetector, findsSeveralFamiliesAtOnce)
{
  cv::RNG random(4);
  cv::Mat gray = grayWall({640, 480});
  TagDetectorParams params;
  params.families = {"tag25h9", "tagCircle21h7", "tag16h5", "tagStandard41h12"};
  std::vector<std::pair<std::string, int>> expected;
  for (const std::string& family : params.families)
    for (const int id : {3, 17})
    {
      const auto i = static_cast<int>(expected.size());
      drawTag(gray, family, id, tagCorners({80.0 + i % 4 * 160.0, 120.0 + i / 4 * 240.0}, 50.0, i));
      expected.emplace_back(family, id);
    }
  photograph(gray, random);
  std::vector<std::pair<std::string, int>> found;
  for (const Tag& tag : TagDetector(params).detect(gray, "mono8"))
    found.emplace_back(tag.family, tag.id);
  EXPECT_EQ(found, expected);
}

TEST(TagDetector, findsTwoHundredTags)
{
  cv::RNG random(5);
  cv::Mat gray = grayWall({1920, 1080});
  const auto truth = drawRows(gray, kFamily, 38.0, 200);
  photograph(gray, random);
  TagDetector detector;
  for (int frame = 0; frame < 4; ++frame)  // in the whole image, then each in its place
  {
    const std::vector<Tag> tags = detector.update(frame * kStep, gray, "mono8");
    ASSERT_EQ(tags.size(), 200U) << frame;
    for (const Tag& tag : tags)
      EXPECT_LT(distance(tag.corners, truth.at(tag.id)), 0.6) << frame << tag.id;
  }
}

TEST(TagDetector, followsMovingTagsLikeASearchOfEveryFrame)
{
  std::vector<std::pair<cv::Mat, std::map<int, TagCorners>>> frames(60);  // in which one tag leaves and comes back
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].first = drawMoving(static_cast<int>(i), {640, 480}, frames[i].second);
  for (const double decimate : {0.0, 1.0, 2.0})
  {
    TagDetectorParams params;
    params.decimate = decimate;
    params.refine_edges = decimate != 1.0;
    TagDetector detector(params), reference(params);
    std::map<int, double> missed_since;
    std::vector<double> errors, differences;
    for (std::size_t frame = 0; frame < frames.size(); ++frame)
    {
      const auto& [gray, truth] = frames[frame];
      const double time = static_cast<double>(frame) * kStep;
      const std::vector<Tag> tags = detector.update(time, gray, "mono8");
      for (const Tag& tag : tags)
      {
        ASSERT_EQ(truth.count(tag.id), 1U) << frame;
        errors.push_back(distance(tag.corners, truth.at(tag.id)));
        EXPECT_LT(errors.back(), tag.id == kLeavingTag ? 6.0 : 1.0) << frame << " " << tag.id;
      }
      for (const Tag& tag : reference.detect(gray, "mono8"))
      {
        const auto same = std::find_if(tags.begin(), tags.end(), [&tag](const Tag& t) { return t.id == tag.id; });
        if (same != tags.end())
        {
          missed_since.erase(tag.id);
          differences.push_back(distance(same->corners, tag.corners));
          continue;
        }
        EXPECT_EQ(tag.id, kLeavingTag) << frame;
        EXPECT_LE(time - missed_since.emplace(tag.id, time).first->second, params.max_search_period) << tag.id;
      }
    }
    EXPECT_GT(differences.size(), 180U);
    EXPECT_LT(median(errors), 0.2);
    // With refined edges, a rounding error in the library may move a corner by a tenth of a pixel.
    std::sort(differences.begin(), differences.end());
    if (decimate > 0.0) EXPECT_LT(differences[differences.size() * 95 / 100], 0.05) << decimate;
    EXPECT_LT(differences.back(), params.refine_edges ? 0.5 : 0.01) << decimate;
  }
}

TEST(TagDetector, followsAFastTagWithoutSearchingElsewhere)
{
  TagDetectorParams params;
  params.decimate = 1.0;
  params.max_search_period = 60.0;
  TagDetector detector(params);
  double x = 60.0;
  for (int frame = 0; x < 1800.0; ++frame)
  {
    cv::Mat gray = grayWall({1920, 160});
    drawTag(gray, kFamily, 8, tagCorners({x, 80.0}, 40.0, 0.1));
    const std::vector<Tag> tags = detector.update(frame * kStep, gray, "mono8");
    ASSERT_EQ(tags.size(), 1U) << frame;
    EXPECT_NEAR(tags[0].center.x, x, 0.5);
    x += std::min(4.0 * frame, 60.0);
  }
}

TEST(TagDetector, findsNeighboursLikeASearchOfTheWholeImage)
{
  TagDetectorParams params;
  params.decimate = 1.0;
  params.refine_edges = false;      // else a rounding error in the library may move a corner by a tenth of a pixel
  const TagDetector owner(params);  // of the family's tables, which take longer to make than all the searches
  cv::RNG random(11);
  for (int i = 0; i < 150; ++i)
  {
    cv::Mat gray = grayWall({320, 240});
    drawTag(gray, kFamily, 1, tagCorners({100.0, 100.0}, 50.0, 0.1));
    const double direction = random.uniform(0.2, 1.4);
    drawTag(gray, kFamily, 2,
            tagCorners(cv::Point2d(100.0, 100.0) +
                           random.uniform(65.0, 110.0) * cv::Point2d(std::cos(direction), std::sin(direction)),
                       random.uniform(20.0, 40.0), random.uniform(0.0, 6.0)));
    photograph(gray, random);
    TagDetector detector(params);
    const std::vector<Tag> expected = detector.update(0.0, gray, "mono8");  // searches the whole image
    for (const double time : {0.03, 0.06})                                  // without and with a known velocity
      EXPECT_LT(difference(detector.update(time, gray, "mono8"), expected), 0.01) << i;
  }
}

TEST(TagDetector, findsANewTagWithinTheSearchPeriod)
{
  TagDetector detector;
  cv::RNG random(6);
  double appeared = 0.0;
  for (int frame = 0; frame < 120; ++frame)
  {
    const double time = frame * kStep;
    cv::Mat gray = grayWall({640, 480});
    drawTag(gray, kFamily, 1, tagCorners({100.0 + frame, 100.0}, 60.0));
    const bool there = frame % 20 > 1;  // 18 of 20 frames, so that every phase of the searches occurs
    if (there)
      drawTag(gray, kFamily, 2, tagCorners({100.0 + 20.0 * (frame / 20), 300.0}, 40.0));
    else
      appeared = time + kStep;
    photograph(gray, random);
    const std::vector<int> ids = idsOf(detector.update(time, gray, "mono8"));
    EXPECT_EQ(std::count(ids.begin(), ids.end(), 1), 1) << frame;
    if (there && time >= appeared + 0.5) EXPECT_EQ(std::count(ids.begin(), ids.end(), 2), 1) << frame;
    if (!there) EXPECT_EQ(std::count(ids.begin(), ids.end(), 2), 0) << frame;
  }
}

TEST(TagDetector, searchesTheWholeImageOftenEnough)
{
  const TagDetector owner;  // of the family's tables, which take longer to make than the searches
  for (const double period : {0.1, 0.5, 1.0})
    for (int phase = 0; phase < 35; phase += 3)
    {
      TagDetectorParams params;
      params.decimate = 1.0;  // without searches for large tags in between
      params.max_search_period = period;
      TagDetector detector(params);
      const cv::Mat empty = grayWall({320, 240});
      cv::Mat gray = empty.clone();
      drawTag(gray, kFamily, 2, tagCorners({100.0, 100.0}, 40.0));
      for (int frame = 0; frame < phase; ++frame)
        EXPECT_TRUE(detector.update(frame * kStep, empty, "mono8").empty());
      int frame = phase;
      while (detector.update(frame * kStep, gray, "mono8").empty())
        ++frame;
      // The tag may have come into view right after the last frame without it.
      EXPECT_LE((frame - phase + (phase > 0 ? 1 : 0)) * kStep, period + 1e-9) << phase;
    }
}

TEST(TagDetector, findsANewLargeTagInAFifthOfTheSearchPeriod)
{
  const TagDetector owner;  // of the family's tables, which take longer to make than the searches
  for (int phase = 0; phase < 16; ++phase)
  {
    TagDetector detector;
    cv::Mat gray = grayWall({640, 480});
    for (int frame = 0; frame < phase; ++frame)
      EXPECT_TRUE(detector.update(frame * kStep, gray, "mono8").empty());
    drawTag(gray, kFamily, 2, tagCorners({300.0, 200.0}, 70.0, 0.5));
    int frame = phase;
    while (detector.update(frame * kStep, gray, "mono8").empty())
      ++frame;
    EXPECT_LE((frame - phase) * kStep, 0.1) << phase;
  }
}

TEST(TagDetector, findsATagAgainWhereItWasCovered)
{
  TagDetector detector(with([](TagDetectorParams& p) { p.max_search_period = 10.0; }));
  for (int frame = 0; frame < 60; ++frame)
  {
    const TagCorners corners = tagCorners({100.0 + 4.0 * frame, 200.0}, 50.0);
    cv::Mat gray = grayWall({640, 480});
    drawTag(gray, kFamily, 5, corners);
    const bool covered = frame % 20 >= 14;
    if (covered) cv::rectangle(gray, cv::Rect(cv::Point(corners[3]), cv::Size(20, 80)), 90, cv::FILLED);
    const std::vector<Tag> tags = detector.update(frame * kStep, gray, "mono8");
    ASSERT_EQ(tags.size(), covered ? 0U : 1U) << frame;
    if (!covered) EXPECT_LT(distance(tags[0].corners, corners), 0.5);
  }
}

TEST(TagDetector, findsALostTagElsewhereAtOnce)
{
  TagDetector detector(with([](TagDetectorParams& p) { p.max_search_period = 1.0; }));
  for (int frame = 0; frame < 40; ++frame)
  {
    cv::Mat gray = grayWall({640, 480});
    drawTag(gray, kFamily, 5, tagCorners({frame < 20 ? 100.0 : 500.0, 200.0}, 50.0));
    EXPECT_EQ(detector.update(frame * kStep, gray, "mono8").size(), 1U) << frame;
  }
}

TEST(TagDetector, reportsBothTagsOfOneId)
{
  TagDetector detector;
  for (int frame = 0; frame < 40; ++frame)
  {
    cv::Mat gray = grayWall({640, 480});
    const std::array<TagCorners, 2> truth = {tagCorners({150.0 + 2.0 * frame, 200.0}, 50.0),
                                             tagCorners({450.0 - 2.0 * frame, 280.0}, 60.0)};
    for (const TagCorners& corners : truth)
      drawTag(gray, kFamily, 9, corners);
    std::vector<Tag> tags = detector.update(frame * kStep, gray, "mono8");
    ASSERT_EQ(tags.size(), 2U) << frame;
    for (std::size_t i = 0; i < tags.size(); ++i)
      EXPECT_LT(distance(tags[i].corners, truth[i]), 0.5) << frame;
  }
}

TEST(TagDetector, searchesEveryFrameCompletelyIfThePeriodIsZero)
{
  const TagDetectorParams params = with([](TagDetectorParams& p) { p.max_search_period = 0.0; });
  TagDetector detector(params), reference(params);
  std::map<int, TagCorners> truth;
  for (int frame = 0; frame < 8; ++frame)
  {
    const cv::Mat gray = drawMoving(10 * frame, {640, 480}, truth);
    EXPECT_EQ(difference(detector.update(frame * kStep, gray, "mono8"), reference.detect(gray, "mono8")), 0.0);
  }
}

TEST(TagDetector, takesPaddedRowsAndColorsWithoutWritingToThem)
{
  cv::RNG random(8);
  cv::Mat gray = grayWall({400, 300});
  const auto truth = drawRows(gray, kFamily, 50.0, 6);
  photograph(gray, random);
  for (const double blur : {0.0, 0.8, -0.8})
  {
    TagDetectorParams params;
    params.decimate = 1.0;
    params.blur = blur;
    TagDetector detector(params);
    const std::vector<Tag> expected = detector.detect(gray.clone(), "mono8");
    EXPECT_EQ(expected.size(), truth.size()) << blur;
    for (const int padding : {1, 100, 2000})
    {
      cv::Mat wide = noise({gray.cols + padding, gray.rows}, CV_8UC1);
      cv::Mat part = wide.colRange(0, gray.cols);
      gray.copyTo(part);
      const cv::Mat before = wide.clone();
      for (int frame = 0; frame < 3; ++frame)  // searches parts of the image, where the library rounds differently
        EXPECT_LT(difference(detector.update(frame * kStep, part, "mono8"), expected), blur == 0.0 ? 0.1 : 0.3);
      EXPECT_EQ(difference(detector.detect(part, "mono8"), expected), 0.0) << padding;
      EXPECT_TRUE(equal(wide, before)) << padding << blur;
    }
    cv::Mat bgr;
    cv::cvtColor(gray, bgr, cv::COLOR_GRAY2BGR);
    EXPECT_EQ(difference(detector.detect(bgr, "bgr8"), expected), 0.0);
  }
}

TEST(TagDetector, takesImagesOfAnySize)
{
  TagDetector detector;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 3), cv::Size(5, 200), cv::Size(200, 3), cv::Size(71, 71),
                              cv::Size(73, 300), cv::Size(8192, 8)})
    for (int frame = 0; frame < 2; ++frame)
      EXPECT_TRUE(detector.update(frame * kStep, noise(size, CV_8UC1), "mono8").empty()) << size;
  cv::Mat small = grayWall({44, 44});
  drawTag(small, kFamily, 3, tagCorners({22.0, 22.0}, 28.0));
  for (int frame = 0; frame < 3; ++frame)
  {
    const std::vector<Tag> tags = detector.update(frame * kStep, small, "mono8");
    ASSERT_EQ(idsOf(tags), std::vector<int>{3});
    EXPECT_LT(distance(tags[0].corners, tagCorners({22.0, 22.0}, 28.0)), 0.5);
  }
}

TEST(TagDetector, forgetsTagsWhenTimeGoesBackOrTheSizeChanges)
{
  TagDetector detector(with([](TagDetectorParams& p) { p.max_search_period = 60.0; }));
  cv::Mat gray = grayWall({320, 240});
  drawTag(gray, kFamily, 3, tagCorners({100.0, 100.0}, 50.0));
  const cv::Mat empty = grayWall({320, 240});
  const cv::Mat larger = grayWall({640, 480});
  EXPECT_TRUE(detector.update(100.0, empty, "mono8").empty());
  EXPECT_TRUE(detector.update(100.1, gray, "mono8").empty());
  EXPECT_EQ(detector.update(5.0, gray, "mono8").size(), 1U);
  EXPECT_TRUE(detector.update(5.1, larger, "mono8").empty());
  EXPECT_EQ(detector.update(5.2, gray, "mono8").size(), 1U);
}

TEST(TagDetector, countsAndLimitsWrongBits)
{
  for (const std::string family : {"tag36h11", "tag16h5", "tagStandard41h12"})
    for (const int wrong : {0, 1, 2, 3})
    {
      cv::Mat paper = paperOf(family, 5);
      const int border = (tagFamily(family).width - tagFamily(family).width_at_border) / 2 + 1;
      for (int i = 0; i < wrong; ++i)  // these cells are data bits in every family
      {
        uchar& cell = paper.at<uchar>(border + 2, border + 2 + i);
        cell = static_cast<uchar>(255 - cell);
      }
      cv::Mat gray = grayWall({320, 240});
      drawPaper(gray, paper, border, tagCorners({160.0, 120.0}, 80.0, 0.2));
      for (const int limit : {0, 1, 2})
      {
        TagDetectorParams params;
        params.families = {family};
        params.max_hamming = limit;
        const std::vector<Tag> tags = TagDetector(params).detect(gray, "mono8");
        const int max_corrected = std::min(limit, family == "tag16h5" ? 1 : 2);
        ASSERT_EQ(tags.size(), wrong <= max_corrected ? 1U : 0U) << family << wrong << limit;
        if (!tags.empty()) EXPECT_EQ(tags[0].hamming, wrong);
      }
    }
}

TEST(TagDetector, findsTagsInTheDarkUnlessTheMinMarginIsHigh)
{
  cv::RNG random(9);
  cv::Mat gray = grayWall({320, 240});
  drawTag(gray, kFamily, 5, tagCorners({160.0, 120.0}, 80.0, 0.2));
  gray.convertTo(gray, CV_8U, 0.1, 5.0);
  addNoise(gray, 1.0, random);
  const std::vector<Tag> tags = TagDetector().detect(gray, "mono8");
  ASSERT_EQ(tags.size(), 1U);
  EXPECT_LT(tags[0].margin, 20.0);
  EXPECT_GT(tags[0].similarity, 0.95);
  EXPECT_TRUE(TagDetector(with([](TagDetectorParams& p) { p.min_margin = 20.0; })).detect(gray, "mono8").empty());
}

TEST(TagDetector, findsTagsHalfInTheShade)
{
  cv::RNG random(10);
  cv::Mat gray = grayWall({320, 240});
  drawTag(gray, kFamily, 5, tagCorners({160.0, 120.0}, 80.0, 0.2));
  cv::Mat shade = gray.colRange(0, 165);
  shade *= 0.6;
  photograph(gray, random);
  const std::vector<Tag> tags = TagDetector().detect(gray, "mono8");
  ASSERT_EQ(tags.size(), 1U);
  EXPECT_GT(tags[0].similarity, 0.88);
}

TEST(TagDetector, configureChangesWhatIsFound)
{
  cv::Mat gray = grayWall({320, 240});
  drawTag(gray, "tag36h11", 5, tagCorners({80.0, 120.0}, 60.0));
  drawTag(gray, "tag25h9", 6, tagCorners({240.0, 120.0}, 60.0));
  TagDetector detector;
  EXPECT_EQ(idsOf(detector.update(0.0, gray, "mono8")), std::vector<int>{5});
  detector.configure(with([](TagDetectorParams& p) { p.families = {"tag25h9"}; }));
  EXPECT_EQ(idsOf(detector.update(0.1, gray, "mono8")), std::vector<int>{6});
  EXPECT_EQ(refusal([&] { detector.configure(with([](TagDetectorParams& p) { p.max_hamming = 3; })); }),
            "max_hamming is 3, must be from 0 to 2");
  EXPECT_EQ(idsOf(detector.update(0.2, gray, "mono8")), std::vector<int>{6});
}

TEST(TagDetector, refusesParametersOutOfRange)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using P = TagDetectorParams;
  EXPECT_EQ(refusalOf([](P& p) { p.families = {}; }), "families is empty, must be at least one");
  EXPECT_EQ(refusalOf(
                [](P& p) {
                  p.families = {"tag16h5", "tag25h9", "tag16h5"};
                }),
            "families is tag16h5 twice, must be each once");
  EXPECT_NE(refusalOf([](P& p) { p.families = {"tag36"}; }).find("tag family is 'tag36', must be one of tag36h11, "),
            std::string::npos);
  for (const double value : {0.5, 2.5, 11.0, -1.0})
    EXPECT_EQ(refusalOf([value](P& p) { p.decimate = value; }).rfind("decimate is ", 0), 0U) << value;
  EXPECT_EQ(refusalOf([nan](P& p) { p.decimate = nan; }),
            "decimate is nan, must be 0 (by the tag's size), 1, 1.5, 2, 3, ... or 10");
  EXPECT_EQ(refusalOf([](P& p) { p.max_hamming = 3; }), "max_hamming is 3, must be from 0 to 2");
  for (const double value : {0.0, 1.0, 1.5, 2.0, 10.0})
    EXPECT_EQ(refusalOf([value](P& p) { p.decimate = value; }), "");
}

TEST(TagDetector, refusesInvalidFrames)
{
  TagDetector detector;
  const cv::Mat gray = grayWall({320, 240});
  EXPECT_NE(refusal([&] { detector.detect(cv::Mat(), "mono8"); }), "");
  EXPECT_NE(refusal([&] { detector.detect(gray, "bgr8"); }), "");
  EXPECT_NE(refusal([&] { detector.update(0.0, gray, "mono9"); }), "");
  EXPECT_EQ(refusal(
                [&] {
                  detector.update(0.0, grayWall({8193, 8}), "mono8");
                }),
            "image is 8193x8, must be at most 8192 px wide and high");
  EXPECT_EQ(refusal([&] { detector.update(std::numeric_limits<double>::infinity(), gray, "mono8"); }),
            "time_s is inf, must be finite");
}
