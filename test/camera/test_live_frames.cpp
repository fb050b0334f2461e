#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/camera/live_frames.hpp"
#include "robot_vision/common/monotonic.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A stream whose frames arrive when a test sends them or takes one.
class LiveFramesTest : public testing::Test
{
protected:
  ~LiveFramesTest() override { end(); }

  /// Sends frames that nobody waits for, and returns when they have been read.
  void send(int count)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    sent_ = count;
    changed_.notify_all();
    changed_.wait(lock, [this] { return waits_ && sent_ == 0; });
  }

  /// Takes a frame while frames arrive one after the other. They have this number in all pixels; 0 is one that cannot
  /// be decoded, and with a negative one the decoder fails.
  bool take(int number)
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      number_ = number;
      arriving_ = true;
      changed_.notify_all();
    }
    return frames_->take(frame_);
  }

  /// Has the next frames be such that they cannot be decoded.
  void fail()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    number_ = 0;
  }

  void end(bool broken = false)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    broken_ = broken;
    changed_.notify_all();
  }

private:
  bool grab()
  {
    std::this_thread::yield();  // to the reader that frames arrive for
    std::unique_lock<std::mutex> lock(mutex_);
    waits_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return ended_ || arriving_ || sent_ > 0; });
    waits_ = false;
    if (broken_) throw std::runtime_error("the connection is lost");
    if (ended_) return false;
    if (sent_ > 0) --sent_;
    ++grabbed_;
    grabbed_ns_ = monotonicNow();
    return true;
  }

  bool retrieve(cv::Mat& image)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    arriving_ = false;
    ++retrieved_;
    retrieved_ns_ = monotonicNow();
    if (number_ < 0) throw std::runtime_error("frame " + std::to_string(number_));
    if (number_ == 0) return false;
    image.create(3, 4, CV_8UC3);
    image.setTo(cv::Scalar::all(number_));
    return true;
  }

  int sent_ = 0;
  int number_ = 0;
  bool arriving_ = false, waits_ = false, ended_ = false, broken_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;

protected:
  int grabbed_ = 0, retrieved_ = 0;                 // how many frames
  std::int64_t grabbed_ns_ = 0, retrieved_ns_ = 0;  // when the last one was
  Frame frame_;
  std::unique_ptr<LiveFrames> frames_ =
      std::make_unique<LiveFrames>([this] { return grab(); }, [this](cv::Mat& image) { return retrieve(image); });
};

}  // namespace

TEST_F(LiveFramesTest, areTheNextOnesForAReaderThatIsTooSlow)
{
  ASSERT_TRUE(take(10));
  EXPECT_EQ(frame_.sequence, 0);
  send(3);  // The first one may be of a burst, and so may the second, which is newer.
  int retrieved = 3;
  for (const int number : {11, 12})
  {
    ASSERT_TRUE(take(number));
    EXPECT_EQ(frame_.image.at<cv::Vec3b>(1, 2), cv::Vec3b::all(number));
    EXPECT_EQ(frame_.sequence, grabbed_ - 1);
    EXPECT_EQ(retrieved_, ++retrieved);  // no image is made of what is left out
    send(3);
  }
}

TEST_F(LiveFramesTest, ofABurstAreKept)
{
  ASSERT_TRUE(take(10));
  send(1);
  const std::int64_t arrival = grabbed_ns_;
  cv::Mat lent = frame_.image;
  ASSERT_TRUE(frames_->take(frame_));
  EXPECT_EQ(frame_.sequence, 1);
  EXPECT_GE(frame_.monotonic_ns, arrival);
  EXPECT_NE(frame_.image.data, lent.data);  // whose owner may have other plans with it
  send(2);
  ASSERT_TRUE(frames_->take(frame_));
  EXPECT_EQ(frame_.sequence, 3);  // the newer one
}

TEST_F(LiveFramesTest, areKeptAgainOnceTheReaderIsFastEnough)
{
  ASSERT_TRUE(take(10));
  send(3);
  bool kept = false;
  for (int ms = 1; !kept; ms *= 2)  // until the reader waits before a frame arrives
  {
    ASSERT_TRUE(take(11));
    std::thread sender(
        [this, ms]
        {
          std::this_thread::sleep_for(std::chrono::milliseconds(ms));
          send(1);
        });
    EXPECT_TRUE(frames_->take(frame_));
    sender.join();
    const int retrieved = retrieved_;
    send(1);
    kept = retrieved_ > retrieved;
  }
  ASSERT_TRUE(frames_->take(frame_));
  EXPECT_EQ(frame_.sequence, grabbed_ - 1);
}

TEST_F(LiveFramesTest, thatAreDamagedAreToldWhenTheReaderAsksForTheNext)
{
  ASSERT_TRUE(take(10));
  fail();
  send(1);
  EXPECT_EQ(refusal<std::invalid_argument>([this] { frames_->take(frame_); }), "a frame cannot be decoded");
  ASSERT_TRUE(take(11));
  EXPECT_EQ(frame_.sequence, 1);
}

TEST_F(LiveFramesTest, haveTheTimeOfTheirArrival)
{
  ASSERT_TRUE(take(1));
  EXPECT_GE(frame_.monotonic_ns, grabbed_ns_);
  EXPECT_LE(frame_.monotonic_ns, retrieved_ns_);
}

TEST_F(LiveFramesTest, areRefusedIfTheyAreDamagedAndGoOn)
{
  EXPECT_EQ(refusal<std::invalid_argument>([this] { take(0); }), "a frame cannot be decoded");
  ASSERT_TRUE(take(2));
  EXPECT_EQ(frame_.sequence, grabbed_ - 2);  // the damaged frame does not count as lost as well
  EXPECT_EQ(refusal<std::invalid_argument>([this] { take(-7); }), "frame -7");
  ASSERT_TRUE(take(3));
  EXPECT_EQ(frame_.sequence, grabbed_ - 3);
}

TEST_F(LiveFramesTest, endWithTheStream)
{
  ASSERT_TRUE(take(1));
  end();
  EXPECT_FALSE(frames_->take(frame_));
  EXPECT_FALSE(frames_->take(frame_));
}

TEST_F(LiveFramesTest, endWithTheReasonForWhichTheStreamCannotBeReadOn)
{
  end(true);
  EXPECT_EQ(refusal<std::invalid_argument>([this] { frames_->take(frame_); }), "the connection is lost");
  EXPECT_FALSE(frames_->take(frame_));
}
