#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "core/camera/v4l2_source.hpp"
#include "support/fake_v4l2.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

std::string readError(V4l2Source& source)
{
  Frame frame;
  return refusal<std::exception>([&] { source.read(frame); });
}

/// Reads the next frame, whose pixels must be its own, and returns its number.
std::int64_t numberOfNext(V4l2Source& source)
{
  Frame frame;
  EXPECT_EQ(source.read(frame), ReadResult::kFrame);
  EXPECT_EQ(cv::countNonZero(frame.image.reshape(1) != frame.sequence), 0);
  return frame.sequence;
}

}  // namespace

TEST(V4l2Source, givesTheDriversFramesWithTheirNumbersAndStamps)
{
  FakeCamera camera;
  V4l2Source source(camera.plug(), CaptureParams());
  EXPECT_EQ(source.description(), "YUYV 640x480 at 30 Hz from /dev/video0");
  camera.stamp_ns = 1234567000;
  for (int i = 0; i < 10; ++i)
  {
    Frame frame;
    ASSERT_EQ(source.read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.encoding, "yuv422_yuy2");
    EXPECT_EQ(frame.monotonic_ns, 1234567000);
    EXPECT_EQ(frame.image.size(), cv::Size(640, 480));
    EXPECT_EQ(cv::countNonZero(frame.image.reshape(1) != i), 0);
  }
}

TEST(V4l2Source, countsLostFramesAndRefusesDamagedOnes)
{
  FakeCamera camera;
  V4l2Source source(camera.plug(), CaptureParams());
  Frame frame;
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  camera.lost = 3;
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.sequence, 4);
  camera.damaged = 1;
  EXPECT_EQ(readError(source), "/dev/video0: frame 5 is marked as damaged by the driver");
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.sequence, 5);  // the damaged frame does not count as lost as well
}

TEST(V4l2Source, givesTheNewestFrameToAReaderThatIsTooSlow)
{
  FakeCamera camera;
  V4l2Source source(camera.plug(), CaptureParams());
  const auto read = [&] { return numberOfNext(source); };
  EXPECT_EQ(read(), 0);
  camera.waiting = 3;  // a delay that the driver's buffers can hold
  EXPECT_EQ(read(), 1);
  EXPECT_EQ(read(), 2);
  camera.lost = 2;  // there was no buffer for two frames before these
  camera.waiting = 3;
  EXPECT_EQ(read(), 7);
  camera.waiting = 2;  // the reader is still too slow, but no frame is lost before these
  EXPECT_EQ(read(), 9);
  EXPECT_EQ(read(), 10);  // it had to wait for this one
  camera.waiting = 2;
  EXPECT_EQ(read(), 11);
}

TEST(V4l2Source, givesTheNewestFrameOfADriverThatNumbersOnlyWhatItGives)
{
  FakeCamera camera;
  V4l2Source source(camera.plug(), CaptureParams());
  const auto read = [&] { return numberOfNext(source); };
  EXPECT_EQ(read(), 0);
  camera.waiting = 4;  // it has no buffer for the next one
  EXPECT_EQ(read(), 4);
  camera.waiting = 2;  // the reader is still too slow
  EXPECT_EQ(read(), 6);
  EXPECT_EQ(read(), 7);  // it had to wait for this one
  camera.waiting = 3;
  EXPECT_EQ(read(), 8);
}

TEST(V4l2Source, losesNoFrameWhereADriverUsesANumberTwice)
{
  FakeCamera camera;
  V4l2Source source(camera.plug(), CaptureParams());
  Frame frame;
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  --camera.sequence;
  camera.waiting = 3;
  for (const int expected : {0, 1, 2})
  {
    ASSERT_EQ(source.read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.sequence, expected);
  }
}

TEST(V4l2Source, refusesFramesThatAreCutShort)
{
  FakeCamera camera;
  std::size_t size = 0;
  camera.frame_bytes = [&size](const v4l2_pix_format&, unsigned) { return std::vector<unsigned char>(size); };
  V4l2Source source(camera.plug(), CaptureParams());
  EXPECT_EQ(readError(source), "/dev/video0: frame 0 is empty");
  size = 614399;
  EXPECT_EQ(readError(source), "/dev/video0: frame 1 has 614399 bytes instead of 614400");
  size = 614400;
  EXPECT_EQ(readError(source), "");
}

TEST(V4l2Source, keepsCountingWhenTheDriversNumbersWrap)
{
  FakeCamera camera;
  camera.first_sequence = std::numeric_limits<unsigned>::max() - 1;
  V4l2Source source(camera.plug(), CaptureParams());
  for (int i = 0; i < 4; ++i)
  {
    Frame frame;
    ASSERT_EQ(source.read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.sequence, i);
  }
}
