#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/camera/live_frames.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr std::int64_t kMs = 1000000;  // ns

/// A stream whose frames arrive when a test sends them or takes one, each `between_` after the one before.
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

  /// Waits for a frame, behind which others come at once, before this thread has woken up.
  bool takeFirstOf(int count)
  {
    number_ = 10;
    at_once_ = count;
    return frames_->take(frame_);
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
  /// It is asked when the reader has come for a frame, before it waits.
  std::int64_t now()
  {
    const std::int64_t time = now_;
    if (const int count = at_once_.exchange(0); count > 0)
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      sent_ = count;
      changed_.notify_all();
    }
    return time;
  }

  bool grab()
  {
    if (arriving_) std::this_thread::yield();  // to the reader that frames arrive for
    std::unique_lock<std::mutex> lock(mutex_);
    waits_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return ended_ || arriving_ || sent_ > 0; });
    waits_ = false;
    if (broken_) throw std::runtime_error("the connection is lost");
    if (ended_) return false;
    if (sent_ > 0) --sent_;
    ++grabbed_;
    now_ += between_;
    grabbed_ns_ = now_;
    return true;
  }

  bool retrieve(cv::Mat& image)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    arriving_ = false;
    ++retrieved_;
    if (number_ < 0) throw std::runtime_error("frame " + std::to_string(number_));
    if (number_ == 0) return false;
    image.create(3, 4, CV_8UC3);
    image.setTo(cv::Scalar::all(number_));
    return true;
  }

  std::atomic<int> at_once_{0};
  int sent_ = 0;
  int number_ = 0;
  std::atomic<bool> arriving_{false};
  bool waits_ = false, ended_ = false, broken_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;

protected:
  int grabbed_ = 0, retrieved_ = 0;  // how many frames
  std::int64_t grabbed_ns_ = 0;      // when the last one was
  std::atomic<std::int64_t> now_{1000 * kMs};
  std::atomic<std::int64_t> between_{0};  // ns, until the next frame
  Frame frame_;
  std::unique_ptr<LiveFrames> frames_ = std::make_unique<LiveFrames>(
      [this] { return grab(); }, [this](cv::Mat& image) { return retrieve(image); }, [this] { return now(); });
};

}  // namespace

TEST_F(LiveFramesTest, areTheNewestForAReaderThatIsTooSlow)
{
  between_ = 10 * kMs;
  ASSERT_TRUE(take(10));
  EXPECT_EQ(frame_.sequence, 0);
  send(9);  // how long the reader works is not known yet
  now_ += 5 * kMs;
  ASSERT_TRUE(frames_->take(frame_));
  for (int round = 0; round < 3; ++round)
  {
    const int retrieved = retrieved_;
    between_ = 5 * kMs;  // since the reader took the last one, and so 10 ms since that came
    send(1);
    between_ = 10 * kMs;
    send(8);
    now_ += 5 * kMs;
    EXPECT_EQ(retrieved_, retrieved + 1);  // no image is made of what is left out
    ASSERT_TRUE(frames_->take(frame_));
    EXPECT_EQ(frame_.sequence, grabbed_ - 1);
    EXPECT_EQ(frame_.monotonic_ns, grabbed_ns_);
  }
}

TEST_F(LiveFramesTest, areAllMadeForAReaderThatIsHardlyTooSlow)
{
  between_ = 33 * kMs;
  ASSERT_TRUE(take(10));
  for (int round = 1; round < 20; ++round)
  {
    send(1);
    now_ += 3 * kMs;
    ASSERT_TRUE(frames_->take(frame_));  // at once
    EXPECT_EQ(frame_.sequence, round);
  }
}

TEST_F(LiveFramesTest, ofABurstAreTheFirstAndTheNewest)
{
  for (int burst = 0; burst < 4; ++burst)
  {
    between_ = 120 * kMs;
    ASSERT_TRUE(burst == 0 ? take(10) : takeFirstOf(1));
    EXPECT_EQ(frame_.sequence, 4 * burst);
    between_ = kMs;
    send(3);
    const cv::Mat lent = frame_.image;
    now_ += 40 * kMs;
    ASSERT_TRUE(frames_->take(frame_));
    EXPECT_EQ(frame_.sequence, 4 * burst + 3);
    EXPECT_EQ(frame_.monotonic_ns, grabbed_ns_);
    EXPECT_NE(frame_.image.data, lent.data);  // whose owner may have other plans with it
    now_ += 12 * kMs;
  }
}

TEST_F(LiveFramesTest, thatAreWaitedForAreNotThoseThatComeBehindThem)
{
  between_ = kMs;
  ASSERT_TRUE(take(10));
  for (int round = 0; round < 100; ++round)
  {
    ASSERT_TRUE(takeFirstOf(2));
    ASSERT_EQ(frame_.sequence, 2 * round + 1);
    ASSERT_TRUE(frames_->take(frame_));
    ASSERT_EQ(frame_.sequence, 2 * round + 2);
  }
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

TEST_F(LiveFramesTest, thatAreDamagedLeaveTheOneBefore)
{
  ASSERT_TRUE(take(10));
  send(1);
  fail();
  send(1);
  EXPECT_EQ(refusal<std::invalid_argument>([this] { frames_->take(frame_); }), "a frame cannot be decoded");
  ASSERT_TRUE(frames_->take(frame_));
  EXPECT_EQ(frame_.sequence, 1);
}

TEST_F(LiveFramesTest, haveTheTimeOfTheirArrival)
{
  between_ = 7 * kMs;
  ASSERT_TRUE(take(1));
  EXPECT_EQ(frame_.monotonic_ns, grabbed_ns_);
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
