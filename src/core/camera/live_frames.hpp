#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// Reads a stream in a thread of its own, as fast as its frames come: what the reader is too slow for must neither wait
/// at the sender, more of it each second, nor be taken for the present. A frame that comes while the reader works is
/// kept for it, as frames come in bursts. If another comes meanwhile, the reader is too slow for the stream: until it
/// is not, images are made only of frames that it waits for, so that a slow machine has more time to read.
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

  /// Gives the frame that is kept, or waits for the next one, at first for that with which the stream begins. Sets its
  /// image, time of arrival and number, in which gaps are frames that were left out. Returns false if there are no
  /// more. Throws std::invalid_argument with the reason if the frame is damaged, which is not numbered then, or if the
  /// stream cannot be read on.
  bool take(Frame& frame);

private:
  void run();
  void readAll();
  void give(std::int64_t arrival);
  void keep(std::int64_t arrival);
  void leaveOut();
  bool makeImage(Frame& frame, std::int64_t arrival);
  std::string retrieveInto(cv::Mat& image);

  Grab grab_;
  Retrieve retrieve_;
  Frame* awaited_ = nullptr;   // what the reader waits for
  std::optional<Frame> kept_;  // what has come while it works
  std::int64_t sequence_ = 0;  // of the next frame
  bool behind_ = false;        // whether the reader is too slow for the stream
  bool left_out_ = false;      // whether a frame was left out since it has waited for one
  std::string damage_;         // that the reader has not been told
  bool ended_ = false;
  bool stop_ = false;
  std::mutex mutex_;  // guards all above but the functions
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace robot_vision
