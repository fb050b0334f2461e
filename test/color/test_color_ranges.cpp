// Ranges of colours in all spaces, against cv::cvtColor and cv::inRange.

#include <gtest/gtest.h>

#include <map>
#include <opencv2/imgproc.hpp>

#include "robot_vision/color/color_range.hpp"
#include "robot_vision/color/hsv.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

const std::map<std::string, int> kCodes = {{"hsv", cv::COLOR_BGR2HSV}, {"hls", cv::COLOR_BGR2HLS},
                                           {"lab", cv::COLOR_BGR2Lab}, {"ycrcb", cv::COLOR_BGR2YCrCb},
                                           {"rgb", cv::COLOR_BGR2RGB}, {"bgr", -1}};

/// 86^3 colours: each channel has every third value, 0 and 255 among them.
cv::Mat_<cv::Vec3b> colorCube()
{
  constexpr int kSide = 86;
  cv::Mat_<cv::Vec3b> cube(kSide * kSide, kSide);
  for (int i = 0; i < kSide * kSide * kSide; ++i)
    cube(i / kSide, i % kSide) =
        cv::Vec3b(static_cast<std::uint8_t>(3 * (i / kSide / kSide)),
                  static_cast<std::uint8_t>(3 * (i / kSide % kSide)), static_cast<std::uint8_t>(3 * (i % kSide)));
  return cube;
}

cv::Mat byOpenCv(const cv::Mat& pixels, const ColorRange& r)
{
  const cv::Scalar low(r.low[0], r.low[1], r.low[2]), high(r.high[0], r.high[1], r.high[2]);
  cv::Mat mask, rest;
  if (r.low[0] <= r.high[0])
  {
    cv::inRange(pixels, low, high, mask);
    return mask;
  }
  cv::inRange(pixels, low, cv::Scalar(255, high[1], high[2]), mask);
  cv::inRange(pixels, cv::Scalar(0, low[1], low[2]), high, rest);
  return mask | rest;
}

cv::Mat maskOf(const cv::Mat& image, const std::string& encoding, const ColorRange& range)
{
  cv::Mat mask;
  ColorMask(range).apply(image, encoding, mask);
  return mask;
}

ColorRange randomRange(const std::string& space, cv::RNG& random)
{
  ColorRange range;
  range.space = space;
  const auto channels = colorChannels(space);
  for (int i = 0; i < 3; ++i)
  {
    range.low[i] = random.uniform(0, channels[i].max + 1);
    range.high[i] = random.uniform(isHue(channels[i]) ? 0 : range.low[i], channels[i].max + 1);
  }
  return range;
}

std::string text(const ColorRange& range)
{
  std::ostringstream stream;
  stream << range.space << " " << range.low << " " << range.high;
  return stream.str();
}

class ColorMaskIn : public testing::TestWithParam<std::string>
{
};

}  // namespace

TEST_P(ColorMaskIn, equalsOpenCvForRandomRanges)
{
  const std::string space = GetParam();
  const cv::Mat_<cv::Vec3b> bgr = colorCube();
  const cv::Mat pixels = converted(bgr, kCodes.at(space));
  cv::RNG random(3);
  int some = 0;
  for (int i = 0; i < 20; ++i)
  {
    const ColorRange range = randomRange(space, random);
    const cv::Mat expected = byOpenCv(pixels, range);
    some += cv::countNonZero(expected) > 0 ? 1 : 0;
    ASSERT_TRUE(equal(maskOf(bgr, "bgr8", range), expected)) << text(range);
  }
  EXPECT_GE(some, 10);
}

TEST_P(ColorMaskIn, equalsOpenCvAtTheEnds)
{
  const std::string space = GetParam();
  const cv::Mat bgr = noise({301, 97}, CV_8UC3);
  const cv::Mat pixels = converted(bgr, kCodes.at(space));
  const auto channels = colorChannels(space);
  const cv::Vec3i all(channels[0].max, channels[1].max, channels[2].max);
  EXPECT_EQ(cv::countNonZero(maskOf(bgr, "bgr8", {space, {0, 0, 0}, all})), bgr.rows * bgr.cols);
  for (int i = 0; i < 3; ++i)
    for (const int value : {0, 1, 100, 128, channels[i].max - 1, channels[i].max})
    {
      ColorRange range = {space, {0, 0, 0}, all};
      range.low[i] = range.high[i] = value;
      EXPECT_TRUE(equal(maskOf(bgr, "bgr8", range), byOpenCv(pixels, range))) << text(range);
    }
}

TEST_P(ColorMaskIn, takesEveryEncodingAndSizeAndLeavesTheImage)
{
  const ColorRange range = {GetParam(), {20, 60, 40}, {140, 230, 200}};
  for (const std::string& encoding : encodings())
    for (const cv::Size size : {cv::Size(80, 60), cv::Size(2, 3), cv::Size(134, 3)})
    {
      if (encoding == "jpeg") continue;
      const cv::Mat image = noise(size, matType(encoding), 3);
      const cv::Mat before = image.clone();
      cv::Mat pixels;
      toSpace(image, encoding, GetParam(), pixels);
      EXPECT_TRUE(equal(pixels, converted(converted(image, encoding, "bgr8"), kCodes.at(GetParam())))) << encoding;
      EXPECT_TRUE(equal(maskOf(image, encoding, range), byOpenCv(pixels, range))) << encoding << " " << size;
      EXPECT_TRUE(equal(image, before)) << encoding;
    }
}

TEST_P(ColorMaskIn, isTheSameWithAnyNumberOfThreads)
{
  const cv::Mat image = noise({640, 201}, CV_8UC3, 1);  // of several parts for each thread
  const ColorRange range = {GetParam(), {150, 20, 20}, {160, 230, 200}};
  const cv::Mat expected = byOpenCv(converted(image, kCodes.at(GetParam())), range);
  for (const int threads : {1, 2, 5, 64})
  {
    const ThreadCount count(threads);
    EXPECT_TRUE(equal(maskOf(image, "bgr8", range), expected)) << threads;
  }
}

TEST_P(ColorMaskIn, aColorIsConvertedAsInAnImage)
{
  const cv::Mat_<cv::Vec3b> bgr = noise({256, 64}, CV_8UC3);
  const cv::Mat_<cv::Vec3b> expected = converted(bgr, kCodes.at(GetParam()));
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; x += 5)
      ASSERT_EQ(toSpace(bgr(y, x), GetParam()), expected(y, x)) << bgr(y, x);
}

TEST_P(ColorMaskIn, aConvertedRangeHoldsAllColors)
{
  const cv::Mat_<cv::Vec3b> bgr = colorCube();
  for (const ColorRange& range : {ColorRange{"hsv", {170, 120, 90}, {6, 255, 200}},  // through red
                                  ColorRange{"hls", {100, 80, 90}, {130, 200, 200}}})
  {
    const ColorRange found = convertRange(range, GetParam());
    EXPECT_EQ(found.space, GetParam());
    const cv::Mat before = maskOf(bgr, "bgr8", range);
    ASSERT_GT(cv::countNonZero(before), 1000);
    EXPECT_EQ(cv::countNonZero(before & ~maskOf(bgr, "bgr8", found)), 0) << text(found);
  }
}

INSTANTIATE_TEST_SUITE_P(Spaces, ColorMaskIn, testing::ValuesIn(colorSpaces()),
                         [](const auto& of) { return of.param; });

TEST(ColorRange, hasTheSpacesOfOpenCv)
{
  std::map<std::string, int> codes = kCodes;
  for (const std::string& space : colorSpaces())
    EXPECT_EQ(codes.erase(space), 1U) << space;
  EXPECT_TRUE(codes.empty());
  std::string letters;
  for (const ColorChannel& channel : colorChannels("ycrcb"))
    letters += channel.name;
  EXPECT_EQ(letters, "ycrcb");
}

TEST(ColorRange, isHsvUnlessSomethingElseIsSaid)
{
  const HsvRange usual;
  const ColorRange range;
  EXPECT_EQ(range.space, "hsv");
  EXPECT_EQ(range.low, cv::Vec3i(usual.h_low, usual.s_low, usual.v_low));
  EXPECT_EQ(range.high, cv::Vec3i(usual.h_high, usual.s_high, usual.v_high));
}

TEST(ColorRange, surroundsAPickedColorInEverySpace)
{
  EXPECT_EQ(text(rangeAround({100, 90, 200}, "lab", 15)), "lab [55, 75, 185] [145, 105, 215]");
  EXPECT_EQ(text(rangeAround({250, 3, 128}, "ycrcb", 20)), "ycrcb [190, 0, 108] [255, 23, 148]");
  EXPECT_EQ(text(rangeAround({250, 3, 128}, "bgr", 0)), "bgr [250, 3, 128] [250, 3, 128]");
  EXPECT_EQ(text(rangeAround({4, 100, 200}, "hls", 10)), "hls [174, 50, 100] [14, 205, 255]");
  EXPECT_EQ(text(rangeAround({90, 100, 200}, "hls", 90)), "hls [0, 50, 100] [180, 205, 255]");
  EXPECT_EQ(text(rangeAround({10, 100, 200}, "hls", 10)), "hls [180, 50, 100] [20, 205, 255]");  // 180 is 0, too
  for (int hue = 0; hue < 180; ++hue)
  {
    const HsvRange hsv = rangeAround({static_cast<std::uint8_t>(hue), 0, 0});
    const ColorRange color = rangeAround({static_cast<std::uint8_t>(hue), 0, 0}, "hsv", defaultMargin("hsv"));
    EXPECT_EQ(color.low, cv::Vec3i(hsv.h_low, hsv.s_low, hsv.v_low));
    EXPECT_EQ(color.high, cv::Vec3i(hsv.h_high, hsv.s_high, hsv.v_high));
  }
  EXPECT_EQ(defaultMargin("lab"), 20);
  EXPECT_EQ(refusal([] { rangeAround({1, 2, 3}, "lab", 91); }), "margin is 91, must be from 0 to 90");
}

TEST(ColorRange, isAsSmallAsItCanBeInAnotherSpace)
{
  const cv::Mat_<cv::Vec3b> bgr = allColors();
  const ColorRange range = {"hsv", {170, 120, 90}, {6, 255, 200}};
  const cv::Mat before = maskOf(bgr, "bgr8", range);
  for (const std::string space : {"hls", "ycrcb"})
  {
    const ColorRange found = convertRange(range, space);
    if (space == "hls")  // whose hues are those of HSV, rounded otherwise
    {
      EXPECT_NEAR(found.low[0], range.low[0], 1);
      EXPECT_NEAR(found.high[0], range.high[0], 1);
    }
    for (int i = 0; i < 3; ++i)
      for (const int step : {1, -1})
      {
        ColorRange smaller = found;
        (step > 0 ? smaller.low : smaller.high)[i] += step;
        EXPECT_GT(cv::countNonZero(before & ~maskOf(bgr, "bgr8", smaller)), 0) << text(smaller);
      }
  }
}

TEST(ColorRange, redOfHlsIsHeldAtBothEnds)
{
  const cv::Mat_<cv::Vec3b> bgr = colorCube();
  const cv::Mat_<cv::Vec3b> hls = converted(bgr, cv::COLOR_BGR2HLS);
  cv::Mat at_end;
  cv::inRange(hls, cv::Scalar(180, 60, 120), cv::Scalar(180, 200, 255), at_end);
  ASSERT_GT(cv::countNonZero(at_end), 0);
  for (const int hue : {0, 5, 10, 170, 179, 180})
  {
    const ColorRange range = rangeAround({static_cast<std::uint8_t>(hue), 100, 200}, "hls", 10);
    EXPECT_EQ(cv::countNonZero(at_end & ~maskOf(bgr, "bgr8", range)), 0) << text(range);
  }
}

TEST(ColorRange, whatIsNoneIsRefused)
{
  const std::string known = ", must be one of hsv, hls, lab, ycrcb, rgb, bgr";
  EXPECT_EQ(refusal([] { colorChannels("cmyk"); }), "space is 'cmyk'" + known);
  EXPECT_EQ(refusal([] { toSpace({1, 2, 3}, "HSV"); }), "space is 'HSV'" + known);
  EXPECT_EQ(refusal([] { convertRange(ColorRange(), "\n"); }), "space is '\\x0a'" + known);
  EXPECT_EQ(refusal([] { ColorMask({"", {}, {}}); }), "space is ''" + known);
  EXPECT_EQ(refusal([] { ColorMask({"lab", {0, 256, 0}, {9, 9, 9}}); }), "a_low is 256, must be from 0 to 255");
  EXPECT_EQ(refusal([] { ColorMask({"ycrcb", {0, 9, 0}, {9, 8, 9}}); }), "cr_high is 8, must be from 9 to 255");
  EXPECT_EQ(refusal([] { ColorMask({"hls", {0, 9, 0}, {181, 9, 9}}); }), "h_high is 181, must be from 0 to 180");
  EXPECT_EQ(refusal([] { ColorMask({"hsv", {0, 0, -1}, {9, 9, 9}}); }), "v_low is -1, must be from 0 to 255");
  EXPECT_EQ(refusal(
                [] {
                  convertRange({"hsv", {180, 0, 0}, {180, 9, 9}}, "lab");
                }),
            "the range holds no colour, so that there is none to look for in lab");
  cv::Mat mask;
  const ColorMask lab({"lab", {0, 0, 0}, {9, 9, 9}});
  EXPECT_THROW(lab.apply(cv::Mat(), "bgr8", mask), std::invalid_argument);
  EXPECT_THROW(lab.apply(cv::Mat(4, 4, CV_8UC1), "rgb8", mask), std::invalid_argument);
}

TEST(ColorMask, reusesTheOutputsMemory)
{
  std::vector<std::uint8_t> memory(60 * 100, 77);
  cv::Mat mask(60, 80, CV_8UC1, memory.data(), 100);
  const cv::Mat image = noise({80, 60}, CV_8UC3);
  const ColorRange range = {"lab", {50, 100, 100}, {200, 160, 200}};
  ColorMask(range).apply(image, "bgr8", mask);
  EXPECT_EQ(mask.data, memory.data());
  EXPECT_TRUE(equal(mask, byOpenCv(converted(image, cv::COLOR_BGR2Lab), range)));
  EXPECT_EQ(memory[80], 77);  // the padding of the first row
}
