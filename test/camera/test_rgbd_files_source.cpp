#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "core/camera/rgbd_files_source.hpp"
#include "robot_vision/camera/open_source.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;

namespace fs = std::filesystem;

namespace
{

/// A recording: the gray level of each color image, and the depth of each depth image, is its number.
class RgbdFolder : public testing::Test
{
protected:
  void SetUp() override
  {
    fs::create_directory(folder_ / "rgb");
    fs::create_directory(folder_ / "depth");
  }

  void write(const std::vector<std::string>& colors, const std::vector<std::string>& depths)
  {
    for (std::size_t i = 0; i < colors.size(); ++i)
      cv::imwrite((folder_ / "rgb" / (colors[i] + ".png")).string(), cv::Mat(6, 8, CV_8UC3, cv::Scalar::all(i)));
    for (std::size_t i = 0; i < depths.size(); ++i)
      cv::imwrite((folder_ / "depth" / (depths[i] + ".png")).string(), cv::Mat(3, 4, CV_16UC1, cv::Scalar(1000.0 * i)));
  }

  CaptureParams params() const
  {
    CaptureParams made;
    made.source = folder_.string();
    made.views = "rgbd";
    return made;
  }

  /// The numbers of the images that belong together.
  std::vector<std::pair<int, int>> pairs(const CaptureParams& of) const
  {
    const auto source = openSource(of);
    std::vector<std::pair<int, int>> found;
    for (Frame frame; source->read(frame) == ReadResult::kFrame; frame = Frame())
      found.emplace_back(frame.image.at<cv::Vec3b>(2, 3)[0], frame.second.pixels.at<std::uint16_t>(1, 2) / 1000);
    return found;
  }

  std::string openError() const
  {
    const std::string error = refusal<SourceError>([this] { openSource(params()); });
    const std::string start = folder_.string() + ": ";
    return error.substr(0, start.size()) == start ? error.substr(start.size()) : error;
  }

  using Pairs = std::vector<std::pair<int, int>>;

  const TempFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

}  // namespace

TEST_F(RgbdFolder, hasPairsInTheOrderOfTheNames)
{
  write({"a", "b", "c"}, {"x1", "x2", "x3"});
  EXPECT_EQ(pairs(params()), (Pairs{{0, 0}, {1, 1}, {2, 2}}));
  const auto source = openSource(params());
  EXPECT_EQ(source->description(), "3 color and depth images at 30 Hz from " + folder_.string());
  Frame frame;
  ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.encoding, "bgr8");
  EXPECT_EQ(frame.image.size(), cv::Size(8, 6));
  EXPECT_EQ(frame.second.encoding, "16UC1");
  EXPECT_EQ(frame.second.pixels.size(), cv::Size(4, 3));
  EXPECT_EQ(frame.sequence, 0);
}

// As associate.py of the benchmark does, the smallest gaps are taken first: 100.030 is nearer to 100.028 than 100.015.
TEST_F(RgbdFolder, hasPairsNearestInTimeIfTheNamesAreStamps)
{
  write({"100.000", "100.015", "100.030", "100.100", "99.5"}, {"100.028", "100.010", "100.125", "99.504"});
  EXPECT_EQ(pairs(params()), (Pairs{{4, 3}, {1, 1}, {2, 0}}));
}

TEST_F(RgbdFolder, hasTheRateOfItsStamps)
{
  write({"100.0", "100.1", "100.2", "100.3"}, {"100.0", "100.1", "100.2", "100.3"});
  EXPECT_NEAR(openSource(params())->rate(), 10.0, 1e-9);
}

TEST_F(RgbdFolder, isReadAgainFromItsBeginning)
{
  write({"a", "b"}, {"a", "b"});
  const auto source = openSource(params());
  for (int round = 0; round < 2; ++round)
  {
    for (int i = 0; i < 2; ++i)
    {
      Frame frame;
      ASSERT_EQ(source->read(frame), ReadResult::kFrame);
      EXPECT_EQ(frame.image.at<cv::Vec3b>(0, 0)[0], i);
      EXPECT_EQ(frame.sequence, 2 * round + i);
    }
    Frame frame;
    EXPECT_EQ(source->read(frame), ReadResult::kEnd);
    source->rewind();
  }
}

// In files of the TUM RGB-D benchmark 5000 is 1 m. What is beyond 65.534 m has no number in mm.
TEST_F(RgbdFolder, hasDepthsInMillimetresWhateverTheScaleOfTheFiles)
{
  write({"a"}, {});
  const cv::Mat depths = (cv::Mat_<std::uint16_t>(1, 4) << 0, 5000, 65535, 12);
  cv::imwrite((folder_ / "depth" / "a.png").string(), depths);
  for (const auto& [scale, expected] : {std::pair(5000.0, cv::Mat_<std::uint16_t>({1, 4}, {0, 1000, 13107, 2})),
                                        std::pair(1000.0, cv::Mat_<std::uint16_t>({1, 4}, {0, 5000, 65535, 12})),
                                        std::pair(100.0, cv::Mat_<std::uint16_t>({1, 4}, {0, 50000, 0, 120}))})
  {
    CaptureParams of = params();
    of.depth_scale = scale;
    Frame frame;
    ASSERT_EQ(openSource(of)->read(frame), ReadResult::kFrame);
    EXPECT_TRUE(equal(frame.second.pixels, expected)) << scale << frame.second.pixels;
    of.source = (folder_ / "depth").string();
    of.views = "one";
    of.pixel_format = "z16";
    ASSERT_EQ(openSource(of)->read(frame), ReadResult::kFrame);
    EXPECT_TRUE(equal(frame.image, expected)) << scale;
  }
}

TEST_F(RgbdFolder, isReadOnlyAsFarAsItIsWanted)
{
  write({"a", "b"}, {"a", "b"});
  std::ofstream(folder_ / "rgb" / "a.png") << "damaged";
  const std::string name = (folder_ / "rgb" / "a.png").string();
  fs::copy_file(folder_ / "rgb" / "b.png", folder_ / "rgb" / "c.png");
  cv::imwrite((folder_ / "depth" / "c.png").string(), cv::Mat(3, 4, CV_8UC1, cv::Scalar(1)));
  std::ofstream(name, std::ios::binary) << "\x89PNG\r\n\x1a\nand no more";
  const auto source = openSource(params());
  Frame frame;
  frame.wanted = {false, true};
  EXPECT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_TRUE(frame.image.empty() && !frame.second.pixels.empty());
  source->rewind();
  frame.wanted = {true, true};
  EXPECT_EQ(refusal([&] { source->read(frame); }).substr(0, name.size()), name);
  EXPECT_EQ(source->read(frame), ReadResult::kFrame);  // a damaged file costs its own frame only
  EXPECT_NE(refusal([&] { source->read(frame); }).find("no depths: expected pixels of 1 x 16 bits"), std::string::npos);
  EXPECT_EQ(source->read(frame), ReadResult::kEnd);
}

TEST_F(RgbdFolder, isNamedIfItIsWrong)
{
  const std::string rgb = (folder_ / "rgb").string();
  EXPECT_EQ(refusal<SourceError>([this] { openSource(params()); }), rgb + ": no images that OpenCV can read are there");
  write({"a", "b"}, {"a"});
  EXPECT_EQ(openError(),
            "2 color images and 1 depth image: expected as many of both, or names that are stamps in s, "
            "1305031102.175304.png");
  fs::remove_all(folder_ / "rgb");
  EXPECT_EQ(openError(), "expected the folders rgb and depth in it, as views is rgbd");
}

TEST_F(RgbdFolder, isNamedIfNoStampsAreNear)
{
  write({"1.0"}, {"1.03"});
  EXPECT_EQ(openError(), "no color image and depth image are within 0.02 s of each other by their names");
}

TEST_F(RgbdFolder, cannotBeAVideo)
{
  const std::string video = (folder_ / "a.mp4").string();
  std::ofstream(video) << "not empty";
  CaptureParams of = params();
  of.source = video;
  EXPECT_EQ(refusal<SourceError>([&] { openSource(of); }),
            video + ": a video has no depths: views must be one or stereo");
  of.source = video + "x";
  EXPECT_EQ(refusal<SourceError>([&] { openSource(of); }), video + "x: no such file or folder");
}
