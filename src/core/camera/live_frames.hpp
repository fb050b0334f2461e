#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <thread>

namespace robot_vision
{

/// A frame of a stream, valid until the next one is taken.
struct LiveFrame
{
  cv::Mat image;
  std::int64_t sequence = 0;      // gaps are frames that nobody has taken
  std::int64_t monotonic_ns = 0;  // of its arrival
};

/// Reads a stream in a thread of its own, as fast as its frames come, and gives the newest one: what a reader is too
/// slow for must neither wait at the sender, more of it each second, nor be taken for the present.
class LiveFrames
{
public:
  /// Waits for the stream's next frame; false if there are no more.
  using Grab = std::function<bool()>;
  /// Makes the image of the frame that was grabbed last, in memory that it may fill or replace; false if it is damaged.
  using Retrieve = std::function<bool(cv::Mat& image)>;

  /// Both functions are called by the thread alone.
  LiveFrames(Grab grab, Retrieve retrieve);
  /// Waits for the end of the last call.
  ~LiveFrames();

  /// Waits for a frame that has not been taken, and returns false if there are no more. Throws std::invalid_argument
  /// with the reason if frames since the last call were damaged.
  bool take(LiveFrame& frame);

private:
  void run();
  void readAll();
  std::string retrieveInto(cv::Mat& image);

  Grab grab_;
  Retrieve retrieve_;
  LiveFrame newest_;
  bool ready_ = false;  // whether the newest frame has not been taken
  std::string damage_;  // of frames since the last call of take()
  bool ended_ = false;
  bool stop_ = false;
  std::mutex mutex_;  // guards all above but the functions
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace robot_vision
