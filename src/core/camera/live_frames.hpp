#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/common/monotonic.hpp"

namespace robot_vision
{

/// Reads a stream in a thread of its own, as fast as its frames come: what the reader is too slow for must neither wait
/// at the sender, more of it each second, nor be taken for the present. The newest frame that has come while the reader
/// works is kept for it. No image is made of frames behind which, as it seems, another comes before the reader is back:
/// a slow machine has more time to read.
class LiveFrames
{
public:
  /// Waits for the stream's next frame; false if there are no more.
  using Grab = std::function<bool()>;
  /// Makes the image of the frame that was grabbed last, in memory that it may fill or replace; false if it is damaged.
  using Retrieve = std::function<bool(cv::Mat& image)>;
  /// The time in ns.
  using Clock = std::function<std::int64_t()>;

  /// The first two functions are called by the thread alone.
  LiveFrames(Grab grab, Retrieve retrieve, Clock now = monotonicNow);
  /// Waits for the end of the last call.
  ~LiveFrames();

  /// Gives the frame that is kept, or waits for the next one, at first for that with which the stream begins. Sets its
  /// image, time of arrival and number, in which gaps are frames that were left out. Returns false if there are no
  /// more. Throws std::invalid_argument with the reason if the frame is damaged, which is not numbered then, or if the
  /// stream cannot be read on.
  bool take(Frame& frame);

private:
  void run();
  void readAll();
  void follow(std::int64_t arrival);
  void give(std::int64_t arrival);
  void keep(std::int64_t arrival);
  bool mayBeWanted(std::int64_t arrival) const;
  std::string makeImage(Frame& frame, std::int64_t arrival);
  std::string retrieveInto(cv::Mat& image);

  Grab grab_;
  Retrieve retrieve_;
  Clock now_;
  Frame* awaited_ = nullptr;             // what the reader waits for
  std::string damage_;                   // of the frame that it has waited for
  std::optional<Frame> kept_;            // the newest that has come while it works
  std::string kept_damage_;              // that it has not been told
  std::int64_t sequence_ = 0;            // of the next frame
  std::int64_t begin_ = 0, work_ = 0;    // ns, when the reader has begun to work, and for how long it did before
  std::optional<std::int64_t> arrival_;  // ns, of the last frame
  std::deque<std::int64_t> gaps_;        // ns, between the last frames
  bool ended_ = false;
  bool stop_ = false;
  std::mutex mutex_;  // guards all above but the functions
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace robot_vision
