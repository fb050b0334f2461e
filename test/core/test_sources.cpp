#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pictures.hpp"
#include "refusal.hpp"
#include "robot_vision/frame_source.hpp"

using namespace robot_vision;

namespace
{

constexpr int kVideoFrames = 12;

CaptureParams from(const std::string& source)
{
  CaptureParams params;
  params.source = source;
  return params;
}

/// What opening the source says, with the kind of error before it.
std::string openError(const CaptureParams& params)
{
  try
  {
    openSource(params);
  }
  catch (const SourceError& e)
  {
    return std::string("wrong: ") + e.what();
  }
  catch (const SourceUnavailable& e)
  {
    return std::string("unavailable: ") + e.what();
  }
  return "";
}

/// A folder that is gone, with all that is in it, at the end of the test.
class Sources : public testing::Test
{
protected:
  void SetUp() override
  {
    char pattern[] = "/tmp/robot_vision_sources_XXXXXX";
    ASSERT_NE(mkdtemp(pattern), nullptr);
    folder_ = pattern;
  }

  void TearDown() override
  {
    for (const std::string& name : names_)
      unlink(path(name).c_str());
    rmdir(folder_.c_str());
  }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string write(const std::string& name, const std::string& bytes)
  {
    names_.push_back(name);
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  std::string writePicture(const std::string& name, const cv::Mat& picture)
  {
    names_.push_back(name);
    cv::imwrite(path(name), picture);
    return path(name);
  }

  /// A video whose frame i has the grey level 20 * i all over.
  std::string writeVideo(const std::string& name)
  {
    names_.push_back(name);
    cv::VideoWriter writer(path(name), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0, {64, 48});
    for (int i = 0; i < kVideoFrames; ++i)
      writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i)));
    return path(name);
  }

  std::string cut(const std::string& name, const std::string& whole, double part)
  {
    std::ifstream file(whole, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return write(name, bytes.substr(0, static_cast<std::size_t>(part * static_cast<double>(bytes.size()))));
  }

  std::string folder_;
  std::vector<std::string> names_;
};

int centreLevel(const Frame& frame)
{
  return frame.image.at<cv::Vec3b>(frame.image.rows / 2, frame.image.cols / 2)[0];
}

}  // namespace

TEST_F(Sources, playVideoFilesAtTheirRateToTheEndAndAgain)
{
  const auto source = openSource(from(writeVideo("ramp.avi")));
  EXPECT_EQ(source->rate(), 10.0);
  for (int round = 0; round < 2; ++round)
  {
    for (int i = 0; i < kVideoFrames; ++i)
    {
      Frame frame;
      ASSERT_EQ(source->read(frame), ReadResult::kFrame);
      EXPECT_EQ(frame.encoding, "bgr8");
      EXPECT_EQ(frame.sequence, round * kVideoFrames + i);
      EXPECT_NEAR(centreLevel(frame), 20 * i, 3);
    }
    Frame frame;
    ASSERT_EQ(source->read(frame), ReadResult::kEnd);
    source->rewind();
  }
}

TEST_F(Sources, fillTheMemoryTheyAreGiven)
{
  for (const std::string& name : {writeVideo("ramp.avi"), std::string("synthetic")})
  {
    CaptureParams params = from(name);
    params.image_width = 64;
    params.image_height = 64;
    const auto source = openSource(params);
    const cv::Size size(64, name == "synthetic" ? 64 : 48);
    cv::Mat memory(size, CV_8UC3);
    Frame frame;
    frame.image = memory;
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.image.data, memory.data) << name;
  }
}

TEST_F(Sources, tellThatAVideoIsTruncated)
{
  const std::string whole = writeVideo("ramp.avi");
  const auto source = openSource(from(cut("half.avi", whole, 0.75)));
  std::string error;
  int frames = 0;
  try
  {
    for (Frame frame; source->read(frame) == ReadResult::kFrame;)
      ++frames;
  }
  catch (const SourceError& e)
  {
    error = e.what();
  }
  EXPECT_GT(frames, 0);
  EXPECT_LT(frames, kVideoFrames);
  EXPECT_NE(error.find(path("half.avi") + ": truncated or damaged, only " + std::to_string(frames) + " of 12"),
            std::string::npos)
      << error;
}

TEST_F(Sources, repeatOnePicture)
{
  const cv::Mat picture = smooth({50, 40});
  const auto source = openSource(from(writePicture("one.png", picture)));
  EXPECT_EQ(source->rate(), 30.0);
  for (int i = 0; i < 3; ++i)
  {
    Frame frame;
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    EXPECT_TRUE(equal(frame.image, picture));
    EXPECT_EQ(frame.sequence, i);
  }
}

TEST_F(Sources, showAFolderOrGlobInTheOrderOfTheNames)
{
  writePicture("b.png", cv::Mat(20, 20, CV_8UC3, cv::Scalar::all(2)));
  writePicture("a.png", cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(1)));
  writePicture("c.jpg", cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(30)));
  write("notes.txt", "not a picture");
  const std::vector<std::pair<std::string, std::vector<int>>> table = {
      {folder_, {1, 2, 30}}, {path("*.png"), {1, 2}}, {path("[bc].*"), {2, 30}}};
  for (const auto& [name, levels] : table)
  {
    const auto source = openSource(from(name));
    Frame frame;
    for (const int level : levels)
    {
      ASSERT_EQ(source->read(frame), ReadResult::kFrame);
      EXPECT_EQ(centreLevel(frame), level) << name;
    }
    EXPECT_EQ(source->read(frame), ReadResult::kEnd);
    source->rewind();
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    EXPECT_EQ(centreLevel(frame), levels.front());
  }
}

TEST_F(Sources, skipDamagedPicturesOfAFolder)
{
  const std::string whole = writePicture("b.jpg", smooth({64, 48}));
  const std::string damaged = cut("a.jpg", whole, 0.6);
  const auto source = openSource(from(folder_));
  Frame frame;
  EXPECT_EQ(refusal([&] { source->read(frame); }), damaged + ": the JPEG is damaged or truncated");
  EXPECT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_EQ(source->read(frame), ReadResult::kEnd);
}

TEST_F(Sources, giveUpOnAFolderOfDamagedPictures)
{
  const std::string whole = writePicture("b.jpg", smooth({64, 48}));
  cut("a.jpg", whole, 0.6);
  cut("b.jpg", whole, 0.6);
  const auto source = openSource(from(folder_));
  Frame frame;
  EXPECT_THROW(source->read(frame), std::invalid_argument);
  EXPECT_THROW(source->read(frame), std::invalid_argument);
  EXPECT_THROW(source->read(frame), SourceError);
}

TEST_F(Sources, thatAreWrongAreNamed)
{
  const std::string picture = writePicture("whole.png", smooth({64, 48}));
  const std::string jpeg = writePicture("whole.jpg", smooth({64, 48}));
  const std::string video = writeVideo("whole.avi");
  const std::vector<std::pair<std::string, std::string>> table = {
      {path("missing.avi"), "no such file or folder"},
      {write("empty.avi", ""), "the file is empty"},
      {write("text.mp4", "This is no video, whatever its name says.\n"), "not a picture or video that FFmpeg can read"},
      {cut("half.jpg", jpeg, 0.5), "the JPEG is damaged or truncated"},
      {cut("half.png", picture, 0.5), "not a picture that OpenCV can read, or damaged"},
      {path("*.tiff"), "no pictures that OpenCV can read are there"},
  };
  for (const auto& [name, why] : table)
  {
    const std::string error = openError(from(name));
    EXPECT_EQ(error.substr(0, 9 + name.size()), "wrong: " + name + ": ");
    EXPECT_NE(error.find(why), std::string::npos) << error;
  }
  const std::string bare = folder_ + "/bare";
  mkdir(bare.c_str(), 0700);
  EXPECT_EQ(openError(from(bare)), "wrong: " + bare + ": no pictures that OpenCV can read are there");
  rmdir(bare.c_str());
}

TEST_F(Sources, thatMayComeLaterAreUnavailable)
{
  EXPECT_EQ(openError(from("/dev/video99")), "unavailable: /dev/video99: cannot be opened: No such file or directory");
  EXPECT_EQ(openError(from("/dev/null")),
            "unavailable: /dev/null: VIDIOC_QUERYCAP failed: Inappropriate ioctl for device");
  EXPECT_EQ(openError(from("http://127.0.0.1:9/stream")),
            "unavailable: http://127.0.0.1:9/stream: the stream cannot be opened");
}

TEST_F(Sources, takeTheDeviceIfNoneIsNamed)
{
  CaptureParams params;
  params.video_device = "/dev/video98";
  EXPECT_NE(openError(params).find("/dev/video98"), std::string::npos);
}

TEST_F(Sources, renderTheScene)
{
  const auto source = openSource(from("synthetic"));
  ASSERT_NE(source->cameraModel(), nullptr);
  EXPECT_EQ(source->cameraModel()->width, 640);
  for (int i = 0; i < 3; ++i)
  {
    Frame frame;
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    cv::Mat expected;
    Scene(SceneParams{}).render(i, expected);
    EXPECT_TRUE(equal(frame.image, expected));
    ASSERT_NE(frame.truth, nullptr);
    EXPECT_EQ(frame.truth->frame, i);
  }
}

TEST(CaptureParams, outOfRangeAreNamed)
{
  const auto with = [](auto CaptureParams::*field, auto value)
  {
    CaptureParams params;
    params.*field = value;
    return refusal([&] { validate(params); });
  };
  EXPECT_EQ(with(&CaptureParams::image_width, 15), "image_width is 15, must be from 16 to 8192");
  EXPECT_EQ(with(&CaptureParams::image_height, 8193), "image_height is 8193, must be from 16 to 8192");
  EXPECT_EQ(with(&CaptureParams::framerate, -1.0), "framerate is -1, must be from 0 to 1000");
  EXPECT_EQ(with(&CaptureParams::pixel_format, "h265"),
            "pixel_format is 'h265', must be yuyv, uyvy, grey, nv12 or mjpeg");
  EXPECT_EQ(with(&CaptureParams::io_method, "dma"), "io_method is 'dma', must be mmap, read or userptr");
  EXPECT_EQ(with(&CaptureParams::video_device, ""), "video_device is '', must be a device such as /dev/video0");
  EXPECT_EQ(with(&CaptureParams::io_method, "userptr"), "");
}
