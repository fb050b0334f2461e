#include <gtest/gtest.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <vector>

#include "core/camera/live_frames.hpp"
#include "robot_vision/common/monotonic.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A stream whose frames, one number each in all pixels, arrive when a test sends them.
class LiveFramesTest : public testing::Test
{
protected:
  ~LiveFramesTest() override { end(); }

  /// Sends frames and waits until they have been read; negative numbers are damaged ones.
  void send(const std::vector<int>& numbers)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    sent_ = numbers;
    next_ = 0;
    changed_.notify_all();
    changed_.wait(lock, [this] { return waits_ && next_ == sent_.size(); });
  }

  void end()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }

  /// The number of the newest frame, -1 if there are no more. The frame before must have stayed as it was.
  int take()
  {
    if (!pixels_.empty()) EXPECT_EQ(cv::norm(frame_.image, pixels_, cv::NORM_INF), 0.0);
    pixels_.release();
    if (!frames_->take(frame_)) return -1;
    pixels_ = frame_.image.clone();
    return frame_.image.at<cv::Vec3b>(1, 2)[1];
  }

private:
  bool grab()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    waits_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return ended_ || next_ < sent_.size(); });
    waits_ = false;
    if (next_ == sent_.size()) return false;
    number_ = sent_[next_++];
    return true;
  }

  bool retrieve(cv::Mat& image)
  {
    if (number_ < -1) throw std::runtime_error("frame " + std::to_string(number_));
    if (number_ < 0) return false;
    image.create(3, 4, CV_8UC3);
    image.setTo(cv::Scalar::all(number_));
    return true;
  }

  std::vector<int> sent_;
  std::size_t next_ = 0;
  int number_ = 0;
  cv::Mat pixels_;  // of the frame that was taken last
  bool waits_ = false, ended_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;

protected:
  LiveFrame frame_;
  std::unique_ptr<LiveFrames> frames_ =
      std::make_unique<LiveFrames>([this] { return grab(); }, [this](cv::Mat& image) { return retrieve(image); });
};

}  // namespace

TEST_F(LiveFramesTest, areTheNewestForAReaderThatIsTooSlow)
{
  send({10});
  EXPECT_EQ(take(), 10);
  EXPECT_EQ(frame_.sequence, 0);
  send({11, 12, 13});
  EXPECT_EQ(take(), 13);
  EXPECT_EQ(frame_.sequence, 3);
  send({14});
  send({15});
  EXPECT_EQ(take(), 15);
  EXPECT_EQ(frame_.sequence, 5);
}

TEST_F(LiveFramesTest, haveTheTimeOfTheirArrival)
{
  const std::int64_t before = monotonicNow();
  send({1});
  const std::int64_t after = monotonicNow();
  EXPECT_EQ(take(), 1);
  EXPECT_GE(frame_.monotonic_ns, before);
  EXPECT_LE(frame_.monotonic_ns, after);
}

TEST_F(LiveFramesTest, areRefusedIfTheyAreDamagedAndGoOn)
{
  send({1, -1, 2});
  EXPECT_EQ(refusal<std::invalid_argument>([this] { take(); }), "a frame cannot be decoded");
  EXPECT_EQ(take(), 2);
  EXPECT_EQ(frame_.sequence, 1);  // the damaged frame does not count as lost as well
  send({-7});
  EXPECT_EQ(refusal<std::invalid_argument>([this] { take(); }), "frame -7");
  send({3});
  EXPECT_EQ(take(), 3);
}

TEST_F(LiveFramesTest, endWithTheStreamWhenTheNewestIsTaken)
{
  send({1, 2});
  end();
  EXPECT_EQ(take(), 2);
  EXPECT_EQ(take(), -1);
  EXPECT_EQ(take(), -1);
}
