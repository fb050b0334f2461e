#include "robot_vision/codes/code_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "robot_vision/scene/scene.hpp"

using namespace robot_vision;

namespace
{

constexpr double kStep = 1.0 / 30.0;  // s

CodeReader following(double period, bool background = false)
{
  CodeReaderParams params;
  params.max_search_period = period;
  params.background = background;
  return CodeReader(params);
}

cv::Mat wall(cv::Size size = {640, 480})
{
  return {size, CV_8UC1, cv::Scalar(200)};
}

/// The scene's QR code with a margin.
cv::Mat codePixels()
{
  static const cv::Mat pixels = []
  {
    const Scene scene{SceneParams()};
    cv::Mat bgr, gray;
    scene.render(0, bgr);
    cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
    const std::vector<SceneObject> objects = scene.truth(0).objects;
    const auto code =
        std::find_if(objects.begin(), objects.end(), [](const SceneObject& one) { return one.name == "qr_code"; });
    const cv::Rect tight = cv::boundingRect(std::vector<cv::Point2f>(code->outline.begin(), code->outline.end()));
    return cv::Mat(gray(tight + cv::Size(20, 20) - cv::Point(10, 10)).clone());
  }();
  return pixels;
}

/// An image of a wall with the code at a place.
cv::Mat withCode(cv::Point place, cv::Mat image = wall())
{
  const cv::Mat pixels = codePixels();
  pixels.copyTo(image(cv::Rect(place, pixels.size())));
  return image;
}

double farthest(const std::vector<cv::Point2d>& a, const std::vector<cv::Point2d>& b)
{
  double max = a.size() == b.size() ? 0.0 : 1e9;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    max = std::max(max, cv::norm(a[i] - b[i]));
  return max;
}

/// Expects the codes that a search of the whole image reads, at the same places.
void expectAsRead(const std::vector<Code>& codes, const cv::Mat& image)
{
  const std::vector<Code> expected = CodeReader().read(image, "mono8");
  ASSERT_EQ(codes.size(), expected.size());
  for (std::size_t i = 0; i < codes.size(); ++i)
  {
    EXPECT_EQ(codes[i].type, expected[i].type);
    EXPECT_EQ(codes[i].data, expected[i].data);
    EXPECT_LT(farthest(codes[i].polygon, expected[i].polygon), 1.5);
  }
}

/// The codes of the first frame in which any are read, while a live camera shows this image.
std::vector<Code> firstSeen(CodeReader& reader, const cv::Mat& image, double begin)
{
  const auto start = std::chrono::steady_clock::now();
  for (double elapsed = 0.0; elapsed < 60.0;)
  {
    const std::vector<Code> codes = reader.update(begin + elapsed, image, "mono8");
    if (!codes.empty()) return codes;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return {};
}

}  // namespace

TEST(CodeReader, keepsNothingOfAnImage)
{
  CodeReader reader;
  const Scene scene{SceneParams()};
  cv::Mat bgr;
  scene.render(0, bgr);
  EXPECT_EQ(reader.read(bgr, "bgr8").size(), 1U);
  bgr.release();
  EXPECT_TRUE(reader.read(cv::Mat(48, 64, CV_8UC1, cv::Scalar(255)), "mono8").empty());
  CodeReader other = std::move(reader);
  scene.render(1, bgr);
  EXPECT_EQ(other.read(bgr, "bgr8").size(), 1U);
}

TEST(FollowedCodes, areReadInEveryFrameAtTheirPlaces)
{
  CodeReader reader = following(60.0);
  for (int frame = 0; frame < 30; ++frame)
  {
    const cv::Mat image = withCode({20 + 12 * frame, 300 - 7 * frame});
    const std::vector<Code> codes = reader.update(10.0 + frame * kStep, image, "mono8");
    ASSERT_EQ(codes.size(), 1U) << frame;
    expectAsRead(codes, image);
  }
}

TEST(FollowedCodes, areLostAtOnceAndFoundAgainAtTheirPlace)
{
  CodeReader reader = following(60.0);
  const cv::Mat shown = withCode({300, 200});
  EXPECT_EQ(reader.update(10.0, shown, "mono8").size(), 1U);
  for (int frame = 1; frame < 5; ++frame)
    EXPECT_TRUE(reader.update(10.0 + frame * kStep, wall(), "mono8").empty());
  EXPECT_EQ(reader.update(10.0 + 5 * kStep, shown, "mono8").size(), 1U);
}

TEST(FollowedCodes, areFoundElsewhereSoonAfterTheyWereLost)
{
  CodeReader reader = following(2.0);
  for (int frame = 0; frame <= 30; ++frame)
    EXPECT_EQ(reader.update(frame * kStep, withCode({20, 20}), "mono8").size(), 1U);
  const cv::Mat elsewhere = withCode({500, 300});
  EXPECT_EQ(reader.update(31 * kStep, elsewhere, "mono8").size(), 1U);  // after more than a fifth of the period
}

TEST(FollowedCodes, areBothReportedIfTheirContentIsTheSame)
{
  CodeReader reader = following(60.0);
  for (int frame = 0; frame < 10; ++frame)
  {
    const cv::Mat image = withCode({400, 300 - 8 * frame}, withCode({20 + 9 * frame, 20}));
    const std::vector<Code> codes = reader.update(frame * kStep, image, "mono8");
    ASSERT_EQ(codes.size(), 2U) << frame;
    expectAsRead(codes, image);
  }
}

TEST(FollowedCodes, areFoundWithinThePeriodInTheTimeOfTheStamps)
{
  CodeReader reader = following(0.5);
  EXPECT_TRUE(reader.update(10.0, wall(), "mono8").empty());
  const cv::Mat shown = withCode({300, 200});
  int frame = 1;
  while (frame < 100 && reader.update(10.0 + frame * kStep, shown, "mono8").empty())
    ++frame;
  EXPECT_LE(frame * kStep, 0.5);
  EXPECT_GT(frame, 10);  // the whole image is not searched in every frame
}

TEST(FollowedCodes, areFoundAtOnceInFramesThatBeginAnew)
{
  CodeReader reader = following(60.0, true);
  EXPECT_EQ(reader.update(10.0, withCode({300, 200}), "mono8").size(), 1U);
  EXPECT_EQ(reader.update(10.1, withCode({20, 20}, wall({320, 240})), "mono8").size(), 1U);  // another size
  EXPECT_EQ(reader.update(3.0, withCode({60, 40}, wall({320, 240})), "mono8").size(), 1U);   // time goes back
  CodeReader always = following(0.0, true);
  for (const int x : {20, 500, 20, 500})
    EXPECT_EQ(always.update(x, withCode({x, 200}), "mono8").size(), 1U);
}

TEST(FollowedCodes, areFoundInTheBackground)
{
  CodeReader reader = following(0.1, true);
  EXPECT_TRUE(reader.update(0.0, wall(), "mono8").empty());
  const cv::Mat shown = withCode({300, 200});
  const std::vector<Code> codes = firstSeen(reader, shown, 1.0);
  ASSERT_EQ(codes.size(), 1U);
  expectAsRead(codes, shown);
}

TEST(FollowedCodes, areFoundEvenIfTheCallerReusesTheMemory)
{
  CodeReader reader = following(60.0, true);
  reader.update(0.0, wall(), "mono8");
  const cv::Mat shown = withCode({300, 200});
  cv::Mat frame = shown.clone();
  EXPECT_TRUE(reader.update(100.0, frame, "mono8").empty());  // begins the only search
  frame.setTo(128);
  EXPECT_EQ(firstSeen(reader, shown, 100.1).size(), 1U);
}

TEST(FollowedCodes, areNotReportedIfTheyAreGoneWhenTheSearchEnds)
{
  CodeReader reader = following(60.0, true);
  reader.update(0.0, wall(), "mono8");
  EXPECT_TRUE(reader.update(100.0, withCode({300, 200}), "mono8").empty());  // begins a search
  for (int frame = 1; frame < 30; ++frame)
    EXPECT_TRUE(reader.update(100.0 + frame * kStep, wall(), "mono8").empty());
}

TEST(CodeReader, refusesOtherTypesAndTimes)
{
  EXPECT_THROW(CodeReader().update(std::nan(""), wall(), "mono8"), std::invalid_argument);
  EXPECT_THROW(CodeReader().read(cv::Mat(), "mono8"), std::invalid_argument);
}
