#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/camera/v4l2_source.hpp"
#include "core/camera/video_decoders.hpp"
#include "support/fake_v4l2.hpp"
#include "support/h264_stream.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr int kKeyframeEvery = 10;
constexpr int kFrames = 3 * kKeyframeEvery;
const cv::Size kSize(176, 144);

/// A smooth image that shifts by 4 px per frame, as yu12.
std::vector<cv::Mat> movingImages(cv::Size size = kSize)
{
  std::vector<cv::Mat> images;
  const cv::Mat wide = smooth({size.width + 4 * kFrames, size.height});
  for (int i = 0; i < kFrames; ++i)
    images.push_back(converted(wide.colRange(4 * i, 4 * i + size.width), cv::COLOR_BGR2YUV_I420));
  return images;
}

double meanError(const cv::Mat& a, const cv::Mat& b)
{
  return a.size() == b.size() ? cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total()) : 255.0;
}

constexpr double kMaxMeanError = 1.5;  // gray levels; consecutive images differ by more than five times that

class H264 : public testing::Test
{
protected:
  void SetUp() override
  {
    if (packets_.empty()) GTEST_SKIP() << "FFmpeg has no libx264 here";
  }

  const std::vector<cv::Mat> images_ = movingImages();
  const std::vector<cv::Mat> packets_ = H264Stream().encode(images_);
  const std::unique_ptr<H264Decoder> decoder_ = makeH264Decoder();
  cv::Mat out_;
};

}  // namespace

TEST_F(H264, decodesEachFrameAtOnce)
{
  for (int i = 0; i < kFrames; ++i)
  {
    ASSERT_TRUE(decoder_->decode(packets_[i], out_)) << i;
    EXPECT_LT(meanError(out_, images_[i]), kMaxMeanError) << i;
  }
  EXPECT_GT(meanError(images_[0], images_[1]), 5 * kMaxMeanError);
}

TEST_F(H264, beginsWithTheNextKeyframe)
{
  for (int i = 3; i < kFrames; ++i)
  {
    ASSERT_EQ(decoder_->decode(packets_[i], out_), i >= kKeyframeEvery) << i;
    if (i >= kKeyframeEvery) EXPECT_LT(meanError(out_, images_[i]), kMaxMeanError) << i;
  }
}

TEST_F(H264, survivesDamagedData)
{
  cv::RNG random(7);
  for (int round = 0; round < 300; ++round)
  {
    cv::Mat hostile = packets_[random.uniform(0, kFrames)].clone();
    switch (round % 3)
    {
      case 0:  // truncated
        hostile = hostile.colRange(0, random.uniform(1, hostile.cols)).clone();
        break;
      case 1:  // some bits flipped
        for (int i = 0; i < 20; ++i)
          hostile.at<std::uint8_t>(random.uniform(0, hostile.cols)) ^=
              static_cast<std::uint8_t>(1 << random.uniform(0, 8));
        break;
      default:  // noise after a start code
        random.fill(hostile.colRange(4, hostile.cols), cv::RNG::UNIFORM, 0, 256);
    }
    refusal([&] { decoder_->decode(hostile, out_); });
  }
  EXPECT_EQ(refusal([&] { decoder_->decode(cv::Mat(), out_); }), "H.264 frame is empty");
  ASSERT_TRUE(decoder_->decode(packets_[0], out_));
  EXPECT_NE(refusal([&] { decoder_->decode(cv::Mat(1, 100, CV_8UC1, cv::Scalar(0xFF)), out_); }), "");
  ASSERT_TRUE(decoder_->decode(packets_[0], out_));
  EXPECT_LT(meanError(out_, images_[0]), kMaxMeanError);
}

TEST_F(H264, convertsTheFullRangeToTheLimitedOne)
{
  H264Stream stream;
  stream.full_range = true;
  const cv::Mat white(kSize.height * 3 / 2, kSize.width, CV_8UC1, cv::Scalar(255));
  cv::Mat black = white.clone();
  black = 0;
  ASSERT_TRUE(decoder_->decode(stream.encode({white}).front(), out_));
  EXPECT_NEAR(cv::mean(out_.rowRange(0, kSize.height))[0], 235.0, 1.0);
  EXPECT_NEAR(cv::mean(out_.rowRange(kSize.height, out_.rows))[0], 240.0, 1.0);
  ASSERT_TRUE(decoder_->decode(stream.encode({black}).front(), out_));
  EXPECT_NEAR(cv::mean(out_)[0], 16.0, 1.0);
}

TEST_F(H264, followsAChangeOfSize)
{
  const std::vector<cv::Mat> larger = movingImages({320, 240});
  ASSERT_TRUE(decoder_->decode(packets_[0], out_));
  ASSERT_TRUE(decoder_->decode(H264Stream().encode(larger).front(), out_));
  EXPECT_LT(meanError(out_, larger[0]), kMaxMeanError);
}

TEST_F(H264, refusesOtherPixelFormats)
{
  H264Stream stream;
  stream.chroma_422 = true;
  EXPECT_EQ(refusal([&] { decoder_->decode(stream.encode(images_).front(), out_); }),
            "H.264 image in the pixel format yuv422p, expected yuv420p or yuvj420p");
}

// No images come before the first keyframe, nor from a damaged or lost frame to the next keyframe. The sequence numbers
// begin with the first image and have gaps for frames that were skipped while waiting for a keyframe. The damaged frame
// is refused and leaves no gap, so that it does not count as lost as well.
TEST_F(H264, isDecodedFromACamera)
{
  FakeCamera camera;
  camera.formats = {{V4L2_PIX_FMT_H264, 16, {{176, 144, {30.0}}}}};
  constexpr int kFirst = 3;
  constexpr int kDamaged = 15;
  constexpr int kLost = 24;
  camera.frame_bytes = [this](const v4l2_pix_format&, unsigned number)
  {
    const cv::Mat& packet = packets_[kFirst + number];
    return kFirst + number == kDamaged ? std::vector<unsigned char>(50, 0xFF)
                                       : std::vector<unsigned char>(packet.datastart, packet.dataend);
  };
  V4l2Source source(camera.plug(), withFormat("h264", kSize.width, kSize.height));
  EXPECT_EQ(source.description(), "H264 176x144 at 30 Hz from /dev/video0");
  std::vector<int> shown;
  std::string errors;
  int without_image = 0;
  for (int i = kFirst; i < kFrames; ++i)
  {
    if (i == kLost) camera.lost = 1, ++i;
    Frame frame;
    ReadResult result = ReadResult::kTimeout;
    errors += refusal([&] { result = source.read(frame); });
    without_image += result == ReadResult::kNoImage ? 1 : 0;
    if (result != ReadResult::kFrame) continue;
    EXPECT_EQ(frame.encoding, "yu12");
    EXPECT_EQ(frame.sequence, i - kKeyframeEvery - (i > kDamaged ? 1 : 0)) << i;
    EXPECT_LT(meanError(frame.image, images_[i]), kMaxMeanError) << i;
    shown.push_back(i);
  }
  EXPECT_EQ(without_image, 7 + 4 + 5);
  EXPECT_EQ(shown, (std::vector<int>{10, 11, 12, 13, 14, 20, 21, 22, 23}));
  EXPECT_EQ(errors, "/dev/video0: frame 12: H.264 frame of 50 bytes: Invalid data found when processing input");
}

TEST_F(H264, goesOnWhereADriverUsesANumberTwice)
{
  FakeCamera camera;
  camera.formats = {{V4L2_PIX_FMT_H264, 16, {{176, 144, {30.0}}}}};
  int packet = 0;
  camera.frame_bytes = [&](const v4l2_pix_format&, unsigned)
  { return std::vector<unsigned char>(packets_[packet].datastart, packets_[packet].dataend); };
  V4l2Source source(camera.plug(), withFormat("h264", kSize.width, kSize.height));
  for (; packet < 3; ++packet)
  {
    Frame frame;
    ASSERT_EQ(source.read(frame), ReadResult::kFrame) << packet;
    EXPECT_LT(meanError(frame.image, images_[packet]), kMaxMeanError) << packet;
    camera.sequence = 0;
  }
}
