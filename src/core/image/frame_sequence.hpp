#pragma once

#include <opencv2/core.hpp>
#include <optional>

namespace robot_vision
{

/// Tells which frames of a stream can be compared with the one before.
class FrameSequence
{
public:
  /// `max_gap_s` is the longest time between two such frames, s.
  explicit FrameSequence(double max_gap_s) : max_gap_(max_gap_s) {}

  /// Whether the frame of this time (s) and size follows on the last one: it is of the same size, not earlier, and not
  /// more than the longest time later. Either way it is the last one from now on.
  bool follows(double time_s, const cv::Size& size)
  {
    const double gap = last_time_ ? time_s - *last_time_ : -1.0;
    const bool is_next = gap >= 0.0 && gap <= max_gap_ && size == size_;
    last_time_ = time_s;
    size_ = size;
    interval_ = is_next ? gap : 0.0;
    return is_next;
  }

  /// Time between the last frame and the one that it follows on, s; 0 if there is none.
  double interval() const { return interval_; }

  /// The next frame follows on none.
  void reset() { last_time_.reset(); }

private:
  double max_gap_;
  std::optional<double> last_time_;  // s
  cv::Size size_;
  double interval_ = 0.0;  // s
};

}  // namespace robot_vision
