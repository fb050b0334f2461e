#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/camera/image_files_source.hpp"
#include "robot_vision/camera/open_source.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"
#include "support/temp_folder.hpp"

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

/// The error message of opening a source, with the kind of error in front; empty if there is no error.
std::string openError(const CaptureParams& params)
{
  try
  {
    const std::string error = refusal<SourceError>([&] { openSource(params); });
    return error.empty() ? "" : "wrong: " + error;
  }
  catch (const SourceUnavailable& e)
  {
    return std::string("unavailable: ") + e.what();
  }
}

class Sources : public testing::Test
{
protected:
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string write(const std::string& name, const std::string& bytes)
  {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  std::string writeImage(const std::string& name, const cv::Mat& image)
  {
    cv::imwrite(path(name), image);
    return path(name);
  }

  /// Writes a video whose frame i has the gray level 20 * i everywhere.
  std::string writeVideo(const std::string& name, int codec = cv::VideoWriter::fourcc('M', 'J', 'P', 'G'))
  {
    cv::VideoWriter writer(path(name), cv::CAP_FFMPEG, codec, 10.0, {64, 48});
    for (int i = 0; i < kVideoFrames; ++i)
      writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i)));
    return path(name);
  }

  static std::string bytesOf(const std::string& file_name)
  {
    std::ifstream file(file_name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  std::string cut(const std::string& name, const std::string& whole, double part)
  {
    const std::string bytes = bytesOf(whole);
    return write(name, bytes.substr(0, static_cast<std::size_t>(part * static_cast<double>(bytes.size()))));
  }

  const TempFolder temporary_;
  const std::string folder_ = temporary_.path().string();
};

int centreGray(const Frame& frame)
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
      EXPECT_NEAR(centreGray(frame), 20 * i, 3);
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
  int frames = 0;
  const std::string error = refusal<SourceError>(
      [&]
      {
        for (Frame frame; source->read(frame) == ReadResult::kFrame;)
          ++frames;
      });
  EXPECT_GT(frames, 0);
  EXPECT_LT(frames, kVideoFrames);
  EXPECT_NE(error.find(path("half.avi") + ": truncated or damaged, only " + std::to_string(frames) + " of 12"),
            std::string::npos)
      << error;
}

TEST_F(Sources, repeatASingleImage)
{
  const cv::Mat image = smooth({50, 40});
  const auto source = openSource(from(writeImage("one.png", image)));
  EXPECT_EQ(source->rate(), 30.0);
  for (int i = 0; i < 3; ++i)
  {
    Frame frame;
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    EXPECT_TRUE(equal(frame.image, image));
    EXPECT_EQ(frame.sequence, i);
  }
}

// The calibration of a camera holds for the pixels as the sensor has them. A poster is turned for the viewer.
TEST_F(Sources, doNotTurnImagesAsTheirExifSays)
{
  // An EXIF segment that only has the orientation 6, which means that the image is to be turned clockwise.
  const std::string exif(
      "\xFF\xE1\0\x22"
      "Exif\0\0"
      "MM\0*\0\0\0\x08"
      "\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  const std::string plain = writeImage("plain.jpg", smooth({64, 48}));
  const std::string jpeg = bytesOf(plain);
  const std::string turned = write("turned.jpg", jpeg.substr(0, 2) + exif + jpeg.substr(2));
  Frame frame;
  ASSERT_EQ(openSource(from(turned))->read(frame), ReadResult::kFrame);
  EXPECT_TRUE(equal(frame.image, readImage(plain)));
  cv::Mat upright;
  cv::rotate(readImage(plain), upright, cv::ROTATE_90_CLOCKWISE);
  EXPECT_TRUE(equal(readUpright(turned), upright));
}

TEST_F(Sources, doNotTurnVideosAsTheirContainerSays)
{
  const std::string plain = path("plain.mp4");
  cv::VideoWriter(plain, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 10.0, {64, 48})
      .write(smooth({64, 48}));
  // In the display matrix of the track, the fixed-point numbers of the identity become those of a quarter turn.
  const std::string none(4, '\0'), one("\0\1\0\0", 4), minus("\xFF\xFF\0\0", 4);
  std::string bytes = bytesOf(plain);
  const std::size_t matrix = bytes.find(one + none + none + none + one, bytes.find("tkhd"));
  ASSERT_NE(matrix, std::string::npos);
  bytes.replace(matrix, 20, none + one + none + minus + none);
  const std::string turned = write("turned.mp4", bytes);
  cv::Mat by_default;
  ASSERT_TRUE(cv::VideoCapture(turned, cv::CAP_FFMPEG).read(by_default));
  ASSERT_TRUE(CV_VERSION_MINOR < 5 || by_default.size() == cv::Size(48, 64));
  Frame frame;
  ASSERT_EQ(openSource(from(turned))->read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.image.size(), cv::Size(64, 48));
}

TEST_F(Sources, showAFolderOrGlobInTheOrderOfTheNames)
{
  writeImage("b.png", cv::Mat(20, 20, CV_8UC3, cv::Scalar::all(2)));
  writeImage("a.png", cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(1)));
  writeImage("c.jpg", cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(30)));
  write("notes.txt", "no image");
  const std::vector<std::pair<std::string, std::vector<int>>> table = {
      {folder_, {1, 2, 30}}, {path("*.png"), {1, 2}}, {path("[bc].*"), {2, 30}}};
  for (const auto& [name, levels] : table)
  {
    const auto source = openSource(from(name));
    Frame frame;
    for (const int level : levels)
    {
      ASSERT_EQ(source->read(frame), ReadResult::kFrame);
      EXPECT_EQ(centreGray(frame), level) << name;
    }
    EXPECT_EQ(source->read(frame), ReadResult::kEnd);
    source->rewind();
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    EXPECT_EQ(centreGray(frame), levels.front());
  }
}

TEST_F(Sources, areDividedIfTheyAreStereo)
{
  const cv::Mat image = smooth({64, 40});
  CaptureParams still = from(writeImage("pair.png", image)), video = from(writeVideo("pair.avi"));
  still.views = video.views = "stereo";
  Frame frame;
  ASSERT_EQ(openSource(still)->read(frame), ReadResult::kFrame);
  EXPECT_TRUE(equal(frame.image, image.colRange(0, 32)));
  EXPECT_TRUE(equal(frame.second.pixels, image.colRange(32, 64)));
  const auto source = openSource(video);
  EXPECT_EQ(source->description(), "video at 10 Hz from " + path("pair.avi") + ", two images side by side");
  for (int round = 0; round < 2; ++round)
  {
    for (int i = 0; i < kVideoFrames; ++i)
    {
      ASSERT_EQ(source->read(frame), ReadResult::kFrame);
      EXPECT_EQ(frame.second.pixels.size(), cv::Size(32, 48));
      EXPECT_NEAR(centreGray(frame), 20 * i, 3);
    }
    EXPECT_EQ(source->read(frame), ReadResult::kEnd);
    source->rewind();
  }
}

TEST_F(Sources, readDepthsFromImageFilesOf16Bits)
{
  const cv::Mat depths = noise({50, 40}, CV_16UC1);
  CaptureParams params = from(folder_);
  params.pixel_format = "z16";
  writeImage("a.png", depths);
  const std::string colors = writeImage("b.png", smooth({50, 40}));
  writeImage("c.png", depths);
  const auto source = openSource(params);
  Frame frame;
  ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.encoding, "16UC1");
  EXPECT_TRUE(equal(frame.image, depths));
  EXPECT_EQ(refusal([&] { source->read(frame); }),
            colors + ": no depths: expected pixels of 1 x 16 bits (CV_16UC1), got 3 x 8 bits (CV_8UC3)");
  EXPECT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_EQ(source->read(frame), ReadResult::kEnd);
  ASSERT_EQ(openSource(from(path("a.png")))->read(frame), ReadResult::kFrame);  // nobody has said that they are depths
  EXPECT_EQ(frame.encoding, "bgr8");
}

TEST_F(Sources, skipDamagedImagesOfAFolder)
{
  const std::string whole = writeImage("b.jpg", smooth({64, 48}));
  const std::string damaged = cut("a.jpg", whole, 0.6);
  const auto source = openSource(from(folder_));
  Frame frame;
  EXPECT_EQ(refusal([&] { source->read(frame); }), damaged + ": the JPEG is damaged or truncated");
  EXPECT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_EQ(source->read(frame), ReadResult::kEnd);
}

TEST_F(Sources, giveUpOnAFolderOfDamagedImages)
{
  const std::string whole = writeImage("b.jpg", smooth({64, 48}));
  cut("a.jpg", whole, 0.6);
  cut("b.jpg", whole, 0.6);
  const auto source = openSource(from(folder_));
  Frame frame;
  EXPECT_THROW(source->read(frame), std::invalid_argument);
  EXPECT_THROW(source->read(frame), std::invalid_argument);
  EXPECT_THROW(source->read(frame), SourceError);
}

TEST_F(Sources, areNamedIfTheyAreWrong)
{
  const std::string image = writeImage("whole.png", smooth({64, 48}));
  const std::string jpeg = writeImage("whole.jpg", smooth({64, 48}));
  const std::string video = writeVideo("whole.mp4", cv::VideoWriter::fourcc('m', 'p', '4', 'v'));
  const std::vector<std::pair<std::string, std::string>> table = {
      {path("missing.avi"), "no such file or folder"},
      {write("empty.avi", ""), "the file is empty"},
      {write("text.mp4", "This is no video, whatever its name says.\n"), "not an image or video that FFmpeg can read"},
      {write("text.png", "hello"), "not an image or video"},
      {cut("half.mp4", video, 0.5), "not an image or video that FFmpeg can read, or truncated"},
      {cut("half.jpg", jpeg, 0.5), "the JPEG is damaged or truncated"},
      {cut("half.png", image, 0.5), " bytes is damaged or truncated"},
      {path("*.tiff"), "no images that OpenCV can read are there"},
  };
  for (const auto& [name, reason] : table)
  {
    const std::string error = openError(from(name));
    EXPECT_EQ(error.substr(0, 9 + name.size()), "wrong: " + name + ": ");
    EXPECT_NE(error.find(reason), std::string::npos) << error;
  }
  const std::string bare = folder_ + "/bare";
  std::filesystem::create_directory(bare);
  EXPECT_EQ(openError(from(bare)), "wrong: " + bare + ": no images that OpenCV can read are there");
}

TEST_F(Sources, tellNoPasswords)
{
  const std::vector<std::pair<std::string, std::string>> table = {
      {"rtsp://admin:s3cret@127.0.0.1:1/live", "rtsp://127.0.0.1:1/live"},
      {"http://admin:s3@cret@127.0.0.1:1?a=b@c", "http://127.0.0.1:1?a=b@c"},
      {"tcp://127.0.0.1:1", "tcp://127.0.0.1:1"},
      {"http://127.0.0.1:1/a@b.mjpg", "http://127.0.0.1:1/a@b.mjpg"},
  };
  for (const auto& [url, shown] : table)
    EXPECT_EQ(openError(from(url)), "unavailable: " + shown + ": the stream cannot be opened");
}

TEST_F(Sources, areUnavailableIfTheyMayComeLater)
{
  EXPECT_EQ(openError(from("/dev/video99")), "unavailable: /dev/video99: cannot be opened: No such file or directory");
  EXPECT_EQ(openError(from("/dev/null")),
            "unavailable: /dev/null: VIDIOC_QUERYCAP failed: Inappropriate ioctl for device");
  EXPECT_EQ(openError(from("http://127.0.0.1:9/stream")),
            "unavailable: http://127.0.0.1:9/stream: the stream cannot be opened");
}

TEST_F(Sources, areDevicesIfTheirLinkLeadsToAMissingDevice)
{
  namespace fs = std::filesystem;
  fs::create_symlink("../../dev/video99", path("front"));
  fs::create_symlink("front", path("camera.v4l"));
  fs::create_symlink("none.mp4", path("film"));
  EXPECT_EQ(openError(from(path("camera.v4l"))),
            "unavailable: " + path("camera.v4l") + ": cannot be opened: No such file or directory");
  EXPECT_EQ(openError(from(path("film"))), "wrong: " + path("film") + ": no such file or folder");
}

TEST_F(Sources, areFilesIfTheyAreMissingInSharedMemory)
{
  const std::string name = "/dev/shm/robot_vision_no_such_file.mp4";
  EXPECT_EQ(openError(from(name)), "wrong: " + name + ": no such file or folder");
}

TEST_F(Sources, keepTheirKind)
{
  const std::string link = path("camera");
  std::filesystem::create_symlink("/dev/null", link);
  CaptureParams params = from(link);
  params.kind = sourceKind(params);
  EXPECT_EQ(params.kind, SourceKind::kDevice);
  std::filesystem::remove(link);
  EXPECT_EQ(openError(params), "unavailable: " + link + ": cannot be opened: No such file or directory");
  EXPECT_EQ(openError(from(link)), "wrong: " + link + ": no such file or folder");
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

TEST(CaptureParams, areNamedIfTheyAreNoChoice)
{
  EXPECT_EQ(
      refusalWith(&CaptureParams::pixel_format, "h265"),
      "pixel_format is 'h265', must be yuyv, uyvy, nv12, nv21, yu12, bgr24, rgb24, mjpeg, bayer_rggb8, bayer_bggr8, "
      "bayer_gbrg8, bayer_grbg8, h264, grey, y16, y10, y10b, z16, yuv or yuvmono10");
  EXPECT_EQ(refusalWith(&CaptureParams::io_method, "dma"), "io_method is 'dma', must be mmap, read or userptr");
  EXPECT_EQ(refusalWith(&CaptureParams::video_device, ""),
            "video_device is '', must be a device such as /dev/video0, or its name");
  EXPECT_EQ(refusalWith(&CaptureParams::io_method, "userptr"), "");
}
