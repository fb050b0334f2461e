#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "callback_gate.hpp"

namespace robot_vision
{

/// Counts what happens to a node's frames. Thread-safe.
class FrameStatistics
{
public:
  using Clock = std::chrono::steady_clock;

  /// A frame was received; `sequence` is the sender's number for it. Gaps in the numbers count as dropped frames.
  void received(std::uint32_t sequence);
  /// Whether the thread that takes the frames waits for one, as it does at first. While it works on one, nothing is
  /// known of what the sender does.
  void setWaiting(bool waits);
  /// The numbers of the frames to come are not related to those before.
  void resumed();
  /// A frame was received that cannot be used.
  void refused(const std::string& reason);
  /// The result of a frame was published; its processing started at `begin`, and `stamp` is its time of capture.
  void published(Clock::time_point begin, const ros::Time& stamp);
  /// Sets the state to report: a text such as "idle: nobody subscribes" and the `level` of diagnostic_msgs. If no frame
  /// has come since the last report, though one is waited for, the warning `silence` is reported instead, unless it is
  /// empty.
  void setState(unsigned char level, const std::string& text, const std::string& silence = "");
  /// The states of a node that processes the images of a topic.
  void setRunning(const std::string& topic);
  /// That of a node that gets images, but lacks something else, in words.
  void setLacking(const std::string& lack, const std::string& topic);
  void setIdle();
  /// That of a node that cannot subscribe, for a reason that may have any text. Returns what is reported.
  std::string setUnsubscribed(const std::string& reason);

  /// Has reports count the frames that were not published over shm for want of memory, see SharedTopic.
  void countUnshared(std::function<std::uint64_t()> unshared);

  struct Totals
  {
    std::uint64_t received = 0;
    std::uint64_t published = 0;
    std::uint64_t dropped = 0;
    std::uint64_t refused = 0;
  };
  Totals totals();

  /// Rates and means since the last report, totals, state and last error.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  struct Period
  {
    Clock::time_point begin = Clock::now();
    std::uint64_t received = 0;
    std::uint64_t published = 0;
    std::uint64_t refused = 0;
    double processing_s = 0.0;  // sum over the published frames
    std::uint64_t stamped = 0;  // published frames that have a stamp
    double age_s = 0.0;         // sum over the stamped frames
  };

  /// What a report tells, which is told without the lock: a log that stands still must not hold up frames.
  struct Report
  {
    Period period;
    double seconds = 0.0;  // its length
    Totals totals;
    unsigned char level = 0;
    std::string state;
    bool becomes_late = false;  // no frame has come for so long that it is to be logged
    std::string last_error;
    std::function<std::uint64_t()> unshared;
  };

  Report takeReport();

  std::mutex mutex_;  // guards all below, which callbacks, capture threads and the diagnostics timer use
  Period period_;
  bool has_sequence_ = false;
  std::uint32_t last_sequence_ = 0;
  bool waits_ = true;
  Totals totals_;
  unsigned char level_ = 0;
  std::string state_ = "starting";
  std::string silence_;
  Clock::time_point last_active_ = Clock::now();  // time of the last report that was not of silence
  bool silence_reported_ = false;
  std::string last_error_ = "none";
  std::function<std::uint64_t()> unshared_;
};

/// Publishes a node's FrameStatistics on /diagnostics, by wall time, so also while simulated time stands still.
class FrameDiagnostics
{
public:
  /// Throws std::invalid_argument if ~diagnostic_period (s) is out of range.
  FrameDiagnostics(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name);
  ~FrameDiagnostics();
  FrameDiagnostics(const FrameDiagnostics&) = delete;
  FrameDiagnostics& operator=(const FrameDiagnostics&) = delete;

  FrameStatistics& statistics() { return *statistics_; }
  std::shared_ptr<FrameStatistics> shared() { return statistics_; }

private:
  CallbackGate gate_;  // to the queue of the timer
  std::shared_ptr<FrameStatistics> statistics_ = std::make_shared<FrameStatistics>();
  double period_;  // s
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace robot_vision
