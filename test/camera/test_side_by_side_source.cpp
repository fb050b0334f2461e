#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/camera/side_by_side_source.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// Gives the same image again and again.
class OneImage : public FrameSource
{
public:
  OneImage(cv::Mat image, std::string encoding) : image_(std::move(image)), encoding_(std::move(encoding)) {}

  ReadResult read(Frame& frame) override
  {
    frame.image = image_;
    frame.encoding = encoding_;
    frame.sequence = 7;
    frame.monotonic_ns = 99;
    return ReadResult::kFrame;
  }

  double rate() const override { return 25.0; }
  bool fillsMemory() const override { return false; }
  std::string description() const override { return "one image"; }
  std::string warning() const override { return "a warning"; }

private:
  cv::Mat image_;
  std::string encoding_;
};

/// Writes gray levels that grow by one into the memory that it is given.
class Ramp : public FrameSource
{
public:
  ReadResult read(Frame& frame) override
  {
    frame.image.create(4, 6, CV_8UC1);
    frame.image.setTo(++level_);
    frame.encoding = "mono8";
    return ReadResult::kFrame;
  }

  double rate() const override { return 25.0; }
  std::string description() const override { return "ramp"; }

private:
  int level_ = 0;
};

/// Gives JPEGs with their numbers, of which the second one is damaged.
class Jpegs : public FrameSource
{
public:
  ReadResult read(Frame& frame) override
  {
    Bytes jpeg = jpegOf(noise({64, 48}, CV_8UC3));
    if (next_ == 1) jpeg.erase(jpeg.end() - 200, jpeg.end() - 2);
    stream_ = rowOf(jpeg);
    frame.image = stream_;
    frame.encoding = "jpeg";
    frame.sequence = next_++;
    return ReadResult::kFrame;
  }

  double rate() const override { return 25.0; }
  bool fillsMemory() const override { return false; }
  std::string description() const override { return "jpegs"; }

private:
  cv::Mat stream_;
  int next_ = 0;
};

Frame divided(const cv::Mat& image, const std::string& encoding, WantedViews wanted = {})
{
  SideBySideSource source(std::make_unique<OneImage>(image, encoding));
  Frame frame;
  frame.wanted = wanted;
  EXPECT_EQ(source.read(frame), ReadResult::kFrame);
  return frame;
}

cv::Mat leftOf(const cv::Mat& image)
{
  return image.colRange(0, image.cols / 2);
}

cv::Mat rightOf(const cv::Mat& image)
{
  return image.colRange(image.cols / 2, image.cols);
}

std::string refusalOf(const cv::Mat& image, const std::string& encoding)
{
  return refusal([&] { divided(image, encoding); });
}

}  // namespace

TEST(SideBySide, showsTheHalvesOfTheWholeImageInItsEncoding)
{
  for (const std::string& encoding : encodings())
    for (const cv::Size size : {cv::Size(64, 48), cv::Size(12, 9)})
    {
      if (encoding == "jpeg") continue;
      const cv::Mat image = colorful(size, encoding), before = image.clone();
      const Frame frame = divided(image, encoding);
      EXPECT_EQ(frame.encoding, encoding);
      EXPECT_EQ(frame.second.encoding, encoding);
      EXPECT_TRUE(equal(image, before)) << encoding;
      if (encoding.rfind("bayer", 0) == 0)  // whose colors at the border depend on what is beside it
      {
        EXPECT_TRUE(equal(frame.image, leftOf(image))) << encoding;
        EXPECT_TRUE(equal(frame.second.pixels, rightOf(image))) << encoding;
        continue;
      }
      const cv::Mat whole = converted(image, encoding, "bgr8");
      EXPECT_TRUE(equal(converted(frame.image, encoding, "bgr8"), leftOf(whole))) << encoding << size;
      EXPECT_TRUE(equal(converted(frame.second.pixels, encoding, "bgr8"), rightOf(whole))) << encoding << size;
    }
}

TEST(SideBySide, dividesDepths)
{
  const cv::Mat depths = noise({6, 4}, CV_16UC1);
  const Frame frame = divided(depths, "16UC1");
  EXPECT_TRUE(equal(frame.image, leftOf(depths)));
  EXPECT_TRUE(equal(frame.second.pixels, rightOf(depths)));
}

TEST(SideBySide, decodesJpegOnce)
{
  const cv::Mat stream = rowOf(jpegOf(smooth({64, 48}))), whole = converted(stream, "jpeg", "bgr8");
  const Frame frame = divided(stream, "jpeg");
  EXPECT_EQ(frame.encoding, "bgr8");
  EXPECT_EQ(frame.second.encoding, "bgr8");
  EXPECT_TRUE(equal(frame.image, leftOf(whole)));
  EXPECT_TRUE(equal(frame.second.pixels, rightOf(whole)));
  EXPECT_EQ(frame.second.pixels.data, frame.image.data + frame.image.cols * 3);  // one decoded image
}

TEST(SideBySide, copiesNoPixelsWhereTheHalvesAreInRows)
{
  for (const char* encoding : {"bgr8", "yuv422_yuy2", "nv12", "mono16"})
  {
    const cv::Mat image = noise({8, 6}, matType(encoding));
    const Frame frame = divided(image, encoding);
    EXPECT_EQ(frame.image.data, image.data) << encoding;
    EXPECT_EQ(frame.second.pixels.data, image.ptr(0) + 4 * image.elemSize()) << encoding;
  }
}

TEST(SideBySide, refusesWhatHasNoTwoHalvesOfTheSameLayout)
{
  const std::vector<std::tuple<std::string, cv::Size, std::string>> table = {
      {"bgr8", {7, 4}, "a bgr8 image of 7x4"},
      {"mono16", {1, 1}, "a mono16 image of 1x1"},
      {"16UC1", {9, 2}, "a 16UC1 image of 9x2"},
      {"yuv422_yuy2", {6, 4}, "a yuv422_yuy2 image of 6x4"},
      {"nv12", {6, 6}, "a nv12 image of 6x4"},
      {"yu12", {10, 3}, "a yu12 image of 10x2"},
      {"bayer_rggb8", {6, 4}, "a bayer_rggb8 image of 6x4"},
  };
  for (const auto& [encoding, size, named] : table)
  {
    const bool in_pairs = size.width % 2 == 0;
    EXPECT_EQ(refusalOf(noise(size, matType(encoding)), encoding),
              named + " cannot be divided into a left and a right one: expected its width to be a multiple of " +
                  (in_pairs ? "4" : "2"));
  }
  EXPECT_NE(refusalOf(rowOf(jpegOf(smooth({7, 5}))), "jpeg").find("a bgr8 image of 7x5 cannot be divided"),
            std::string::npos);
  EXPECT_NE(refusalOf(cv::Mat(), "bgr8").find("is empty"), std::string::npos);
}

TEST(SideBySide, makesOnlyTheHalvesThatAreWanted)
{
  Bytes damaged = jpegOf(noise({64, 48}, CV_8UC3));
  damaged.erase(damaged.end() - 200, damaged.end() - 2);
  const Frame none = divided(rowOf(damaged), "jpeg", {false, false});  // else it would be refused
  EXPECT_TRUE(none.image.empty() && none.second.pixels.empty());
  EXPECT_NE(refusalOf(rowOf(damaged), "jpeg"), "");

  const cv::Mat image = noise({8, 6}, CV_8UC3);
  const Frame left = divided(image, "bgr8", {true, false}), right = divided(image, "bgr8", {false, true});
  EXPECT_TRUE(equal(left.image, leftOf(image)) && left.second.pixels.empty());
  EXPECT_TRUE(equal(right.second.pixels, rightOf(image)) && right.image.empty());
}

TEST(SideBySide, countsNoDamagedFrameAsLostAsWell)
{
  SideBySideSource source(std::make_unique<Jpegs>());
  Frame frame;
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.sequence, 0);
  EXPECT_NE(refusal([&] { source.read(frame); }), "");
  for (int expected = 1; expected < 3; ++expected)
  {
    ASSERT_EQ(source.read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.sequence, expected);
  }
}

TEST(SideBySide, keepsAllElseOfTheSource)
{
  SideBySideSource source(std::make_unique<OneImage>(noise({8, 6}, CV_8UC3), "bgr8"));
  Frame frame;
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.sequence, 7);
  EXPECT_EQ(frame.monotonic_ns, 99);
  EXPECT_EQ(source.rate(), 25.0);
  EXPECT_EQ(source.description(), "one image, two images side by side");
  EXPECT_EQ(source.warning(), "a warning");
  EXPECT_EQ(source.cameraModel(), nullptr);
  EXPECT_EQ(source.secondCamera(), nullptr);
}

TEST(SideBySide, givesASourceTheSameMemoryAgain)
{
  SideBySideSource source(std::make_unique<Ramp>());
  std::vector<const unsigned char*> places;
  for (int level = 1; level <= 3; ++level)
  {
    Frame frame;
    ASSERT_EQ(source.read(frame), ReadResult::kFrame);
    EXPECT_TRUE(equal(frame.second.pixels, cv::Mat(4, 3, CV_8UC1, cv::Scalar(level))));
    places.push_back(frame.image.data);
  }
  EXPECT_EQ(places[1], places[0]);
  EXPECT_EQ(places[2], places[0]);
}
