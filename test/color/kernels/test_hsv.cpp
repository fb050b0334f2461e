#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgproc.hpp>

#include "robot_vision/color/hsv.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/hsv_ranges.hpp"
#include "support/images.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

/// cv::inRange on an HSV image, or the union of two if the range goes through red.
cv::Mat byOpenCv(const cv::Mat& hsv, const HsvRange& r)
{
  cv::Mat mask;
  if (r.h_low <= r.h_high)
  {
    cv::inRange(hsv, cv::Scalar(r.h_low, r.s_low, r.v_low), cv::Scalar(r.h_high, r.s_high, r.v_high), mask);
    return mask;
  }
  cv::Mat rest;
  cv::inRange(hsv, cv::Scalar(r.h_low, r.s_low, r.v_low), cv::Scalar(255, r.s_high, r.v_high), mask);
  cv::inRange(hsv, cv::Scalar(0, r.s_low, r.v_low), cv::Scalar(r.h_high, r.s_high, r.v_high), rest);
  return mask | rest;
}

cv::Mat toHsvImage(const cv::Mat& bgr)
{
  cv::Mat hsv;
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  return hsv;
}

cv::Mat maskOf(const cv::Mat& image, const std::string& encoding, const HsvRange& range)
{
  cv::Mat mask;
  HsvMask(range).apply(image, encoding, mask);
  return mask;
}

/// An image with every colour once, and the same in HSV.
class HsvMaskOfAllColors : public testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    bgr_ = allColors();
    hsv_ = toHsvImage(bgr_);
  }

  static void TearDownTestSuite()
  {
    bgr_.release();
    hsv_.release();
  }

  static void expectEqual(const HsvRange& range, const cv::Mat& bgr = bgr_, const cv::Mat& hsv = hsv_)
  {
    EXPECT_EQ(cv::norm(maskOf(bgr, "bgr8", range), byOpenCv(hsv, range), cv::NORM_INF), 0.0) << text(range);
  }

  static cv::Mat_<cv::Vec3b> bgr_;
  static cv::Mat hsv_;
};

cv::Mat_<cv::Vec3b> HsvMaskOfAllColors::bgr_;
cv::Mat HsvMaskOfAllColors::hsv_;

}  // namespace

TEST_F(HsvMaskOfAllColors, equalsOpenCv)
{
  expectEqual(HsvRange{});
  expectEqual(hsvRange({0, 35, 0}, {57, 255, 255}));
  expectEqual(hsvRange({0, 0, 0}, {180, 255, 255}));
  expectEqual(hsvRange({0, 0, 0}, {179, 0, 255}));      // gray
  expectEqual(hsvRange({0, 1, 0}, {179, 12, 255}));     // nearly gray
  expectEqual(hsvRange({0, 0, 200}, {180, 60, 255}));   // white
  expectEqual(hsvRange({0, 0, 0}, {180, 255, 40}));     // black
  expectEqual(hsvRange({0, 128, 0}, {180, 170, 255}));  // limits that many pairs of value and difference hit exactly
  expectEqual(hsvRange({0, 255, 1}, {180, 255, 255}));
  expectEqual(hsvRange({20, 0, 255}, {140, 255, 255}));  // more than half of all hues
  expectEqual(hsvRange({45, 0, 0}, {134, 255, 255}));    // half of them
}

TEST_F(HsvMaskOfAllColors, goesThroughRed)
{
  expectEqual(hsvRange({170, 100, 100}, {10, 255, 255}));
  expectEqual(hsvRange({179, 0, 0}, {0, 255, 255}));
  expectEqual(hsvRange({180, 0, 0}, {0, 255, 255}));
  expectEqual(hsvRange({180, 30, 0}, {57, 255, 255}));
  expectEqual(hsvRange({91, 0, 0}, {0, 255, 200}));
  expectEqual(hsvRange({100, 20, 20}, {99, 255, 255}));
  expectEqual(hsvRange({160, 0, 7}, {140, 80, 255}));
}

TEST_F(HsvMaskOfAllColors, equalsOpenCvForRandomRanges)
{
  cv::RNG random(7);
  for (int i = 0; i < 20; ++i)
  {
    const int s = random.uniform(0, 256);
    const int v = random.uniform(0, 256);
    const HsvRange range = hsvRange({random.uniform(0, 181), s, v},
                                    {random.uniform(0, 181), random.uniform(s, 256), random.uniform(v, 256)});
    const auto part = [i](const cv::Mat& all)  // every eighth row, which has all greens, and of each blue some
    { return cv::Mat(all.rows / 8, all.cols, all.type(), const_cast<uchar*>(all.ptr(i % 8)), 8 * all.step); };
    expectEqual(range, part(bgr_), part(hsv_));
  }
}

TEST_F(HsvMaskOfAllColors, toHsvEqualsOpenCv)
{
  for (int y = 0; y < bgr_.rows; y += 5)
    for (int x = 0; x < bgr_.cols; x += 3)
      ASSERT_EQ(toHsv(bgr_(y, x)), hsv_.at<cv::Vec3b>(y, x)) << bgr_(y, x);
}

TEST(HsvMask, equalsOpenCvForEveryHue)
{
  cv::Mat_<cv::Vec3b> bgr(3 * 256, 256);  // the smallest channel may be 0, because a hue depends only on differences
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256; ++j)
      for (int zero = 0; zero < 3; ++zero)
      {
        cv::Vec3b& color = bgr(zero * 256 + i, j);
        color[(zero + 1) % 3] = static_cast<std::uint8_t>(i);
        color[(zero + 2) % 3] = static_cast<std::uint8_t>(j);
        color[zero] = 0;
      }
  const cv::Mat hsv = toHsvImage(bgr);
  for (int low = 0; low <= 180; ++low)
    for (const int high : {low, (low + 10) % 180, (low + 89) % 180, (low + 90) % 180, (low + 170) % 180, 180})
    {
      const HsvRange range = hsvRange({low, 0, 0}, {high, 255, 255});
      EXPECT_TRUE(equal(maskOf(bgr, "bgr8", range), byOpenCv(hsv, range))) << text(range);
    }
}

TEST(HsvMask, equalsOpenCvForEverySaturation)
{
  cv::Mat_<cv::Vec3b> bgr(256, 256);  // a saturation depends only on the largest and the smallest channel
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256; ++j)
      bgr(i, j) = cv::Vec3b(static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), static_cast<std::uint8_t>(j));
  const cv::Mat hsv = toHsvImage(bgr);
  constexpr std::array<int, 3> kLowValues = {0, 1, 60};  // combined in turn with the kinds of upper limits
  for (int low = 0; low < 256; ++low)
    for (int i = 0; i < 3; ++i)
    {
      const std::array<int, 3> highs = {low, std::min(low + 40, 255), 255};
      const HsvRange range = hsvRange({0, low, kLowValues[(low + i) % 3]}, {180, highs[i], 255});
      EXPECT_TRUE(equal(maskOf(bgr, "bgr8", range), byOpenCv(hsv, range))) << text(range);
    }
}

TEST(HsvMask, takesEveryEncodingAndSize)
{
  const HsvRange range = hsvRange({10, 60, 20}, {75, 240, 230});
  for (const std::string& encoding : encodings())
    for (const cv::Size size : {cv::Size(80, 60), cv::Size(2, 3), cv::Size(134, 3)})
    {
      if (encoding == "jpeg") continue;
      const cv::Mat image = noise(size, matType(encoding), 3);
      const cv::Mat before = image.clone();
      cv::Mat bgr;
      toBgr(image, encoding, bgr);
      const cv::Mat mask = maskOf(image, encoding, range);
      EXPECT_TRUE(equal(mask, byOpenCv(toHsvImage(bgr), range))) << encoding << " " << size;
      EXPECT_TRUE(equal(image, before)) << encoding;
    }
}

TEST(HsvMask, takesRowsOfEveryLength)
{
  const HsvRange range = hsvRange({170, 0, 0}, {60, 255, 255});
  for (int width = 1; width < 100; ++width)
  {
    const cv::Mat image = noise({width, 2}, CV_8UC3, 1);
    EXPECT_TRUE(equal(maskOf(image, "bgr8", range), byOpenCv(toHsvImage(image), range))) << width;
  }
}

TEST(HsvMask, isTheSameWithAnyNumberOfThreads)
{
  const cv::Mat image = noise({75, 201}, CV_8UC3, 1);
  const cv::Mat expected = byOpenCv(toHsvImage(image), HsvRange{});
  for (const int threads : {1, 2, 5, 64})
  {
    const ThreadCount count(threads);
    EXPECT_TRUE(equal(maskOf(image, "bgr8", HsvRange{}), expected)) << threads;
  }
}

TEST(HsvMask, reusesTheOutputsMemory)
{
  std::vector<std::uint8_t> memory(60 * 100, 77);
  cv::Mat mask(60, 80, CV_8UC1, memory.data(), 100);
  const cv::Mat image = smooth({80, 60});
  HsvMask().apply(image, "bgr8", mask);
  EXPECT_EQ(mask.data, memory.data());
  EXPECT_TRUE(equal(mask, byOpenCv(toHsvImage(image), HsvRange{})));
  EXPECT_EQ(memory[80], 77);  // the padding of the first row
}

TEST(HsvMask, refusesEmptyImagesAndOtherTypes)
{
  cv::Mat mask;
  for (const std::string encoding : {"bgr8", "rgb8"})
  {
    EXPECT_THROW(HsvMask().apply(cv::Mat(), encoding, mask), std::invalid_argument);
    EXPECT_THROW(HsvMask().apply(cv::Mat(4, 4, CV_8UC1), encoding, mask), std::invalid_argument);
  }
}
