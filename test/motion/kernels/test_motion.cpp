#include "robot_vision/motion/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/image/gaussian_filter_rows.hpp"
#include "core/motion/frame_difference.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

/// As courses write it.
cv::Mat byOpenCv(const cv::Mat& image, const cv::Mat& background, const MotionParams& p,
                 const std::string& encoding = "bgr8")
{
  std::vector<cv::Mat> blurred;
  for (const cv::Mat& frame : {background, image})
  {
    const bool is_bgr = encoding == "bgr8";
    cv::Mat gray = is_bgr ? converted(frame, cv::COLOR_BGR2GRAY) : converted(frame, encoding, "mono8");
    gray = gray.clone();  // beyond a part of a larger image the filter would look at that image
    cv::GaussianBlur(gray, gray, {p.blur_size, p.blur_size}, 0.0);
    blurred.push_back(gray);
  }
  cv::Mat mask;
  cv::absdiff(blurred[0], blurred[1], mask);
  cv::threshold(mask, mask, p.threshold, 255.0, cv::THRESH_BINARY);
  cv::dilate(mask, mask, cv::Mat(), {-1, -1}, p.dilate);
  return mask;
}

/// The image with a box of noise in it.
cv::Mat withBox(const cv::Mat& image, const cv::Rect& box)
{
  cv::Mat changed = image.clone();
  noise(box.size(), CV_8UC3, 5).copyTo(changed(box));
  return changed;
}

void expectTheOpenCvChain(const cv::Mat& before, const cv::Mat& after, const MotionParams& params)
{
  MotionDetector detector(params);
  detector.update(0.0, before, "bgr8");
  EXPECT_TRUE(equal(detector.update(1.0, after, "bgr8").mask, byOpenCv(after, before, params)))
      << before.size() << ", blur " << params.blur_size << ", threshold " << params.threshold << ", dilation "
      << params.dilate << ", " << cv::getNumThreads() << " threads";
}

}  // namespace

TEST(MotionDetector, equalsTheOpenCvChain)
{
  for (const cv::Size size : {cv::Size(320, 240), cv::Size(97, 61), cv::Size(1, 1), cv::Size(5, 200), cv::Size(200, 3)})
    for (const int blur_size : {1, 3, 21, 99})
      for (const double threshold : {0.0, 25.0, 255.0})
      {
        MotionParams params;
        params.blur_size = blur_size;
        params.threshold = threshold;
        params.dilate = blur_size == 3 ? 0 : 2;
        params.max_changed = 1.0;
        MotionDetector detector(params);
        const cv::Mat background = smooth(size);
        EXPECT_EQ(cv::countNonZero(detector.update(0.0, background, "bgr8").mask), 0);
        const cv::Rect whole({0, 0}, size);
        for (const cv::Rect& box : {cv::Rect(0, 0, 40, 30), cv::Rect(60, 20, 30, 41), whole, cv::Rect(96, 60, 1, 1)})
        {
          if ((box & whole).empty()) continue;
          const cv::Mat image = withBox(background, box & whole);
          const cv::Mat before = image.clone();
          const Motion motion = detector.update(1.0, image, "bgr8");
          const cv::Mat expected = byOpenCv(image, background, params);
          EXPECT_TRUE(equal(motion.mask, expected)) << size << blur_size << threshold << box;
          EXPECT_EQ(motion.changed, cv::countNonZero(expected) / static_cast<double>(size.area()));
          EXPECT_TRUE(equal(image, before));
        }
      }
}

TEST(MotionDetector, equalsTheOpenCvChainForAdversarialImages)
{
  cv::RNG random(0x307104);
  std::optional<ThreadCount> threads;  // chosen seldom: to end and start OpenCV's threads takes a while
  for (int i = 0; i < 200; ++i)
  {
    if (i % 50 == 0) threads.emplace(1 + i / 50);
    const cv::Size size(random.uniform(1, 200), random.uniform(1, 120));
    MotionParams params;
    params.method = i % 3 == 0 ? "previous_frame" : "first_frame";
    params.blur_size = 1 + 2 * random.uniform(0, i % 10 == 0 ? 50 : 16);
    params.threshold = random.uniform(0, 2) == 0 ? random.uniform(0.0, 255.0) : random.uniform(0, 30);
    params.dilate = random.uniform(0, i % 10 == 1 ? 51 : 4);
    params.max_changed = 1.0;
    const cv::Mat before = converted(adversarial(size, i), cv::COLOR_GRAY2BGR);
    cv::Mat after = converted(adversarial(size, i / 6), cv::COLOR_GRAY2BGR);
    if (i % 2 == 0) cv::bitwise_not(after, after);
    expectTheOpenCvChain(before, after, params);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "images " << i;
  }
}

TEST(MotionDetector, equalsTheOpenCvChainWherePartsFarFromEachOtherMove)
{
  cv::RNG random(0x307105);
  std::optional<ThreadCount> threads;
  for (int i = 0; i < 120; ++i)
  {
    if (i % 40 == 0) threads.emplace(1 + i / 40);
    const cv::Size size(random.uniform(200, 800), random.uniform(60, 200));
    MotionParams params;
    params.method = i % 3 == 0 ? "previous_frame" : "first_frame";
    params.blur_size = 1 + 2 * random.uniform(0, i % 4 == 0 ? 50 : 12);
    params.threshold = i % 2 == 0 ? 0.0 : random.uniform(0, 10);
    params.dilate = random.uniform(0, i % 3 == 1 ? 51 : 4);
    params.max_changed = 1.0;
    const cv::Mat before = smooth(size);
    cv::Mat after = before.clone();
    for (int parts = random.uniform(1, 6); parts > 0; --parts)
    {
      const cv::Point at(random.uniform(0, size.width), random.uniform(0, size.height));
      const cv::Size of(random.uniform(1, 20), random.uniform(1, 20));
      cv::Mat part = after(cv::Rect(at, of) & cv::Rect({0, 0}, size));
      cv::bitwise_not(part, part);
    }
    expectTheOpenCvChain(before, after, params);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "images " << i;
  }
}

TEST(FrameDifference, areTheSameByOpenCvAndWriteAllOfTheMask)
{
  const cv::Mat before = smooth({160, 120}), image = withBox(before, {60, 40, 50, 20});
  const MotionParams params;
  const Reference reference{converted(before, cv::COLOR_BGR2GRAY), {}};
  for (const bool is_changed : {true, false})
    for (const bool by_opencv : {true, false})
    {
      const cv::Mat& frame = is_changed ? image : before;
      cv::Mat mask(before.size(), CV_8UC1, cv::Scalar(99));
      const cv::Rect part = by_opencv ? FrameDifference::findByOpenCv({frame, "bgr8"}, reference, params, mask)
                                      : FrameDifference().find({frame, "bgr8"}, reference, params, mask);
      EXPECT_TRUE(equal(mask, byOpenCv(frame, before, params)));
      EXPECT_EQ(part & cv::boundingRect(mask), cv::boundingRect(mask));
      EXPECT_EQ(part.empty(), !is_changed);
      EXPECT_LT(part.height, mask.rows);
    }
}

TEST(FrameDifference, keepNothingFromOneImageToTheNext)
{
  cv::RNG random(0x307106);
  FrameDifference changed;  // one for all
  std::optional<ThreadCount> threads;
  for (int i = 0; i < 100; ++i)
  {
    if (i % 25 == 0) threads.emplace(i == 0 ? 3 : 5 - i / 25);  // more of them and fewer than before
    const cv::Size size(random.uniform(1, 300), random.uniform(1, 200));
    MotionParams params;
    params.blur_size = 1 + 2 * random.uniform(0, i % 4 == 0 ? 50 : 12);
    params.threshold = random.uniform(0, 30);
    params.dilate = random.uniform(0, i % 3 == 1 ? 51 : 4);
    const std::string encoding = i % 2 == 0 ? "bgr8" : "mono8";
    const cv::Mat before = colorful(size, encoding);
    cv::Mat after = before.clone();
    const cv::Rect box(random.uniform(0, size.width), random.uniform(0, size.height), 1 + size.width / 4, 9);
    cv::Mat part = after(box & cv::Rect({0, 0}, size));
    cv::bitwise_not(part, part);
    Reference reference{converted(before, encoding, "mono8"), {}};
    if (i % 3 != 0) reference.blurred = blurred(reference.gray.clone(), params.blur_size);
    cv::Mat mask(size, CV_8UC1, cv::Scalar(99));
    changed.find({after, encoding}, reference, params, mask);
    ASSERT_TRUE(equal(mask, byOpenCv(after, before, params, encoding))) << i << ", " << size;
  }
}

TEST(FrameDifference, lookAtNothingBesideAGrayImage)
{
  const cv::Size size(150, 70);
  constexpr int kStep = 200;
  const int bytes = kStep * (size.height - 1) + size.width;  // none after the last pixel
  std::vector<std::uint8_t> memory(static_cast<std::size_t>(bytes), 255);
  cv::Mat alone(size, CV_8UC1, memory.data(), kStep);
  noise(size, CV_8UC1).copyTo(alone);
  const cv::Mat before = alone.clone();
  cv::Mat frame(size + cv::Size(40, 40), CV_8UC1, cv::Scalar(255));
  cv::Mat part = frame(cv::Rect({20, 20}, size));
  before.copyTo(part);
  for (const int blur_size : {1, 21, 99})
    for (const bool is_changed : {false, true})
    {
      alone.at<std::uint8_t>(35, 70) =
          is_changed ? 255 - before.at<std::uint8_t>(35, 70) : before.at<std::uint8_t>(35, 70);
      alone.copyTo(part);
      MotionParams params;
      params.blur_size = blur_size;
      params.threshold = 0.0;
      const cv::Mat expected = byOpenCv(alone, before, params, "mono8");
      for (const cv::Mat& image : {alone, part})
        for (const bool by_opencv : {false, true})
        {
          cv::Mat mask(size, CV_8UC1);
          const EncodedImage compared{image, "mono8"};
          const Reference reference{before, {}};
          if (by_opencv)
            FrameDifference::findByOpenCv(compared, reference, params, mask);
          else
            FrameDifference().find(compared, reference, params, mask);
          EXPECT_TRUE(equal(mask, expected)) << blur_size << is_changed << by_opencv;
        }
    }
}

TEST(MotionDetector, equalsTheOpenCvChainForEveryEncoding)
{
  for (const std::string& encoding : encodings())
    for (const char* const method : {"first_frame", "previous_frame"})
    {
      cv::Mat before, after;
      if (encoding == "jpeg")
      {
        before = rowOf(jpegOf(smooth({80, 60})));
        after = rowOf(jpegOf(withBox(smooth({80, 60}), {20, 20, 30, 20})));
      }
      else
      {
        before = colorful({80, 60}, encoding);
        after = before.clone();
        after(cv::Rect(10, 10, 30, 20)).setTo(0);
      }
      const cv::Mat kept = after.clone();
      MotionParams params{method};
      params.max_changed = 1.0;
      params.threshold = 4.0;
      MotionDetector detector(params);
      const Motion none = detector.update(0.0, before, encoding);
      EXPECT_EQ(none.mask.size(), imageSize(before, encoding)) << encoding;
      const Motion motion = detector.update(1.0, after, encoding);
      EXPECT_TRUE(equal(motion.mask, byOpenCv(after, before, params, encoding))) << encoding << " " << method;
      EXPECT_GT(cv::countNonZero(motion.mask), 0) << encoding;
      EXPECT_TRUE(equal(after, kept)) << encoding;
    }
}

TEST(MotionDetector, anImageThatCannotBeReadIsNoBackground)
{
  const cv::Mat bgr = smooth({80, 60});
  const cv::Mat jpeg = rowOf(jpegOf(bgr));
  const cv::Mat broken(jpeg.size(), CV_8UC1, cv::Scalar(0));
  MotionDetector detector;
  EXPECT_ANY_THROW(detector.update(0.0, broken, "jpeg"));
  EXPECT_EQ(cv::countNonZero(detector.update(1.0, jpeg, "jpeg").mask), 0);
  EXPECT_ANY_THROW(detector.update(2.0, broken, "jpeg"));
  EXPECT_EQ(detector.update(3.0, jpeg, "jpeg").mask.size(), bgr.size());
}

TEST(GaussianFilterRows, areOpenCvsForEverySize)
{
  if (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 5) GTEST_SKIP() << "of older OpenCV they may not be";
  for (int size = 1; size < 100; size += 2)
    EXPECT_TRUE(GaussWeights(size).areExact()) << size;
}

TEST(MotionDetector, equalsTheOpenCvChainInEveryEncodingAndUnderNoise)
{
  const cv::Size size(199, 120);
  cv::Mat background = smooth(size), grains(size, CV_16SC3);
  cv::RNG(3).fill(grains, cv::RNG::NORMAL, 0.0, 9.0);  // colours differ by more than the threshold, gray does not
  cv::Mat noisy;
  cv::add(background, grains, noisy, cv::noArray(), CV_8U);
  cv::Mat box = noisy(cv::Rect(70, 40, 41, 30));
  cv::bitwise_not(box, box);
  ASSERT_GT(cv::norm(background(cv::Rect(0, 0, 60, 120)), noisy(cv::Rect(0, 0, 60, 120)), cv::NORM_INF), 25.0);
  const std::vector<std::pair<std::string, int>> codes = {{"bgr8", -1},
                                                          {"rgb8", cv::COLOR_BGR2RGB},
                                                          {"bgra8", cv::COLOR_BGR2BGRA},
                                                          {"rgba8", cv::COLOR_BGR2RGBA},
                                                          {"mono8", cv::COLOR_BGR2GRAY}};
  for (const auto& [encoding, code] : codes)
  {
    MotionDetector detector;
    detector.update(0.0, converted(background, code), encoding);
    const Motion motion = detector.update(1.0, converted(noisy, code), encoding);
    EXPECT_TRUE(equal(motion.mask, byOpenCv(noisy, background, MotionParams()))) << encoding;
    ASSERT_EQ(motion.regions.size(), 1U) << encoding;
    EXPECT_EQ(motion.regions[0].area, cv::countNonZero(motion.mask)) << encoding;
  }
}

TEST(MotionDetector, anotherEncodingIsANewBackground)
{
  const cv::Mat bgr = smooth({160, 120}), rgb = converted(bgr, cv::COLOR_BGR2RGB);
  MotionDetector detector;
  detector.update(0.0, bgr, "bgr8");
  EXPECT_EQ(detector.update(1.0, withBox(rgb, {10, 10, 40, 40}), "rgb8").changed, 0.0);
  EXPECT_GT(detector.update(2.0, rgb, "rgb8").changed, 0.0);
}

TEST(MotionDetector, masksStayAsTheyAreAndBeginBlack)
{
  const cv::Mat empty(120, 160, CV_8UC3, cv::Scalar::all(40));
  const std::vector<cv::Rect> boxes = {{10, 20, 40, 30}, {90, 60, 50, 40}, {60, 10, 30, 30}};
  MotionDetector detector, fresh;
  detector.update(0.0, empty, "bgr8");
  std::vector<Motion> kept;
  for (int round = 0; round < 2; ++round)  // first all are held, then none
  {
    for (const cv::Rect& box : boxes)
    {
      cv::Mat moved = empty.clone();
      moved(box).setTo(220);
      fresh.reset();
      fresh.update(0.0, empty, "bgr8");
      const cv::Mat expected = fresh.update(1.0, moved, "bgr8").mask.clone();
      Motion motion = detector.update(1.0, moved, "bgr8");
      EXPECT_TRUE(equal(motion.mask, expected)) << box;
      if (round == 0) kept.push_back(std::move(motion));
    }
    for (std::size_t i = 0; i < kept.size(); ++i)
      EXPECT_EQ(cv::boundingRect(kept[i].mask) & boxes[i], boxes[i]);
    kept.clear();
  }
}

TEST(MotionDetector, outlinesAreWithinAPixelOfTheMask)
{
  const cv::Mat empty(240, 320, CV_8UC3, cv::Scalar::all(40));
  cv::Mat moved = empty.clone();
  cv::circle(moved, {150, 120}, 60, cv::Scalar::all(200), cv::FILLED);
  MotionDetector detector;
  detector.update(0.0, empty, "bgr8");
  const Motion motion = detector.update(1.0, moved, "bgr8");
  ASSERT_EQ(motion.regions.size(), 1U);
  std::vector<std::vector<cv::Point>> borders;
  cv::findContours(motion.mask, borders, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  ASSERT_EQ(borders.size(), 1U);
  EXPECT_LT(motion.regions[0].outline.size(), borders[0].size() / 8);
  for (const cv::Point& point : borders[0])
    EXPECT_LE(std::abs(cv::pointPolygonTest(motion.regions[0].outline, point, true)), 1.0 + 1e-6) << point;
}

TEST(MotionDetector, comparesWithTheFirstOrThePreviousFrame)
{
  const cv::Mat empty = smooth({160, 120}), full = withBox(empty, {40, 30, 50, 50});
  MotionDetector first, previous(MotionParams{"previous_frame"});
  const auto regions = [](MotionDetector& detector, double time, const cv::Mat& image)
  { return detector.update(time, image, "bgr8").regions.size(); };
  const std::vector<cv::Mat> seen = {empty, full, full, empty};
  std::vector<std::size_t> of_first, of_previous;
  for (std::size_t i = 0; i < seen.size(); ++i)
  {
    of_first.push_back(regions(first, static_cast<double>(i), seen[i]));
    of_previous.push_back(regions(previous, static_cast<double>(i), seen[i]));
  }
  EXPECT_EQ(of_first, (std::vector<std::size_t>{0, 1, 1, 0}));
  EXPECT_EQ(of_previous, (std::vector<std::size_t>{0, 1, 0, 1}));
  first.reset();
  EXPECT_EQ(regions(first, 4.0, full), 0U);
  EXPECT_EQ(regions(first, 5.0, full), 0U);
  EXPECT_EQ(regions(first, 6.0, empty), 1U);
}

TEST(MotionDetector, otherParametersAreAsIfTheyHadBeenThereFromTheBeginning)
{
  const cv::Mat empty = smooth({160, 120}), full = withBox(empty, {40, 30, 50, 50});
  const std::vector<std::string> methods = {"first_frame", "previous_frame", "running_average", "mog2"};
  for (const std::string& method : methods)
  {
    MotionParams before{method}, after{method};
    after.blur_size = 7;
    after.threshold = 40.0;
    after.dilate = 5;
    after.min_area = 100.0;
    after.ignore_light = true;
    MotionDetector detector(before), expected(after);
    for (MotionDetector* one : {&detector, &expected})
      one->update(0.0, empty, "bgr8");
    detector.configure(after);
    const Motion motion = detector.update(1.0, full, "bgr8"), same = expected.update(1.0, full, "bgr8");
    EXPECT_FALSE(same.regions.empty()) << method;
    EXPECT_TRUE(equal(motion.mask, same.mask)) << method;
    EXPECT_EQ(motion.regions.size(), same.regions.size()) << method;
  }
}

TEST(MotionDetector, anotherMethodIsANewBackgroundAndWhatIsRefusedChangesNothing)
{
  const cv::Mat empty = smooth({160, 120}), full = withBox(empty, {40, 30, 50, 50});
  const std::vector<std::string> methods = {"mog2", "previous_frame", "first_frame", "running_average", "mog2"};
  MotionDetector detector;
  double time = 0.0;
  for (const std::string& method : methods)
  {
    detector.configure(MotionParams{method});
    EXPECT_EQ(detector.update(++time, empty, "bgr8").changed, 0.0) << method;
    EXPECT_THROW(detector.configure(MotionParams{"magic"}), std::invalid_argument);
    MotionDetector expected(MotionParams{method});
    expected.update(0.0, empty, "bgr8");
    EXPECT_TRUE(equal(detector.update(++time, full, "bgr8").mask, expected.update(1.0, full, "bgr8").mask)) << method;
  }
}

TEST(MotionDetector, boxesWhatMoved)
{
  const cv::Mat empty(240, 320, CV_8UC3, cv::Scalar::all(40));
  cv::Mat moved = empty.clone();
  const cv::Rect large(30, 40, 80, 60), small(200, 150, 40, 40), tiny(290, 20, 6, 6);
  for (const cv::Rect& box : {large, small, tiny})
    moved(box).setTo(220);
  MotionDetector detector;
  detector.update(0.0, empty, "bgr8");
  const Motion motion = detector.update(0.1, moved, "bgr8");
  ASSERT_EQ(motion.regions.size(), 2U);
  for (const std::size_t i : {0, 1})
  {
    const cv::Rect truth = i == 0 ? large : small, found = motion.regions[i].box;
    EXPECT_GT((found & truth).area() / static_cast<double>((found | truth).area()), 0.5);
    EXPECT_EQ(found & truth, truth);  // the blur makes it wider
  }
}

TEST(MotionDetector, whatStaysBecomesBackground)
{
  const cv::Mat empty = smooth({160, 120}), full = withBox(empty, {40, 30, 50, 50});
  for (const char* method : {"running_average", "mog2"})
  {
    MotionDetector detector(MotionParams{method});
    double time = 0.0;
    for (; time < 2.0; time += 0.1)
      EXPECT_TRUE(detector.update(time, empty, "bgr8").regions.empty()) << method;
    EXPECT_EQ(detector.update(time, full, "bgr8").regions.size(), 1U) << method;
    Motion motion;
    for (const double end = time + 20.0; time < end; time += 0.1)
      motion = detector.update(time, full, "bgr8");
    EXPECT_TRUE(motion.regions.empty()) << method;
  }
}

TEST(MotionDetector, whatStaysIsMotionForAsLongForBothMethodsThatLearn)
{
  const cv::Mat empty(32, 32, CV_8UC3, cv::Scalar::all(0));
  cv::Mat full = empty.clone();
  full(cv::Rect(8, 8, 16, 16)).setTo(255);
  const auto framesOfMotion = [&](const char* method, double learning_rate)
  {
    MotionParams params{method};
    params.learning_rate = learning_rate;
    params.blur_size = 1;
    params.min_area = 50;
    MotionDetector detector(params);
    detector.update(0.0, empty, "bgr8");
    int frames = 0;
    while (frames < 1000 && !detector.update(1.0, full, "bgr8").regions.empty())
      ++frames;
    return frames;
  };
  for (const double rate : {0.005, 0.05, 0.1, 0.3, 0.5, 0.9, 1.0})
  {
    const int average = framesOfMotion("running_average", rate), mog2 = framesOfMotion("mog2", rate);
    EXPECT_GE(mog2, 1) << rate;
    EXPECT_NEAR(mog2, average, 1.0 + 0.1 * average) << rate;
  }
  EXPECT_EQ(framesOfMotion("running_average", MotionParams().learning_rate), 45);  // as its description says
}

TEST(MotionDetector, aLampIsNoMotion)
{
  const cv::Mat dark = smooth({160, 120}) * 0.5;
  const cv::Mat lit = dark + cv::Scalar::all(70), with_box = withBox(lit, {40, 30, 40, 40});
  for (const char* method : {"first_frame", "running_average"})
  {
    MotionDetector detector(MotionParams{method});
    detector.update(0.0, dark, "bgr8");
    for (const double time : {1.0, 1.5, 2.0})  // the default settles after a second
    {
      const Motion motion = detector.update(time, lit, "bgr8");
      EXPECT_TRUE(motion.everywhere && motion.regions.empty()) << method << time;
    }
    EXPECT_FALSE(detector.update(2.1, lit, "bgr8").everywhere) << method;
    const Motion motion = detector.update(2.2, with_box, "bgr8");
    ASSERT_EQ(motion.regions.size(), 1U) << method;
    EXPECT_NEAR(motion.regions[0].center.x, 59.5, 10.0);  // noise: what is like the wall does not show
  }
  MotionParams params;
  params.ignore_light = true;
  MotionDetector detector(params);
  detector.update(0.0, dark, "bgr8");
  EXPECT_TRUE(detector.update(1.0, lit, "bgr8").regions.empty());
  const Motion motion = detector.update(1.1, with_box, "bgr8");
  EXPECT_FALSE(motion.everywhere);
  EXPECT_EQ(motion.regions.size(), 1U);
}

TEST(MotionDetector, anImageOfAnotherSizeOrAnEarlierTimeIsABackground)
{
  MotionParams params;
  params.method = "running_average";
  MotionDetector detector(params);
  detector.update(5.0, cv::Mat(40, 60, CV_8UC1, cv::Scalar(0)), "mono8");
  EXPECT_EQ(detector.update(6.0, cv::Mat(41, 60, CV_8UC1, cv::Scalar(200)), "mono8").changed, 0.0);
  EXPECT_EQ(detector.update(7.0, cv::Mat(41, 60, CV_8UC1, cv::Scalar(0)), "mono8").changed, 1.0);
  EXPECT_EQ(detector.update(1.0, cv::Mat(41, 60, CV_8UC1, cv::Scalar(0)), "mono8").changed, 0.0);
  EXPECT_THROW(detector.update(8.0, cv::Mat(), "mono8"), std::invalid_argument);
  EXPECT_THROW(detector.update(8.0, cv::Mat(41, 60, CV_8UC1), "bgr8"), std::invalid_argument);
}

TEST(MotionDetector, refusesATimeThatIsNone)
{
  const cv::Mat empty(32, 32, CV_8UC3, cv::Scalar::all(0));
  MotionParams params;
  params.method = "running_average";
  MotionDetector detector(params);
  detector.update(5.0, empty, "bgr8");
  for (const double time : {std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(detector.update(time, empty, "bgr8"), std::invalid_argument) << time;
  cv::Mat full = empty.clone();
  full(cv::Rect(8, 8, 16, 16)).setTo(255);
  EXPECT_EQ(detector.update(1.0, full, "bgr8").changed, 0.0);  // still an earlier time
}

TEST(MotionDetector, refusesWhatIsOutOfRange)
{
  EXPECT_EQ(refusalWith(&MotionParams::method, "magic"),
            "method is magic, must be first_frame, previous_frame, running_average or mog2");
  EXPECT_EQ(refusalWith(&MotionParams::blur_size, 20), "blur_size is 20, must be odd and from 1 to 99");
}
