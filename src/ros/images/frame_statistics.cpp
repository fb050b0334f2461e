#include "frame_statistics.hpp"

#include <algorithm>
#include <utility>

#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr std::chrono::seconds kSilenceTimeout(5);  // without frames until a warning is logged

/// The period in s. It is also checked here because the error of diagnostic_updater would not name the parameter.
double readPeriod(const ros::NodeHandle& pnh)
{
  double period = 1.0;
  readParam(pnh, "diagnostic_period", period);
  requireRange("diagnostic_period", period, 0.01, 3600.0);
  return period;
}

}  // namespace

void FrameStatistics::received(std::uint32_t sequence)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  // A larger step means another sender or a number that went back. (Senders in the process may leave all numbers at 0.)
  constexpr std::uint32_t kMaxLost = 10000;
  const std::uint32_t missing = sequence - last_sequence_ - 1;
  if (has_sequence_ && missing < kMaxLost) totals_.dropped += missing;
  has_sequence_ = true;
  last_sequence_ = sequence;
  ++totals_.received;
  ++period_.received;
}

void FrameStatistics::setWaiting(bool waits)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  waits_ = waits;
}

void FrameStatistics::resumed()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  has_sequence_ = false;
}

void FrameStatistics::refused(const std::string& reason)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  last_error_ = reason;
  ++totals_.refused;
  ++period_.refused;
}

void FrameStatistics::published(Clock::time_point begin, const ros::Time& stamp)
{
  const double processing_s = std::chrono::duration<double>(Clock::now() - begin).count();
  const double age_s = ros::Time::now().toSec() - stamp.toSec();
  const std::lock_guard<std::mutex> lock(mutex_);
  ++totals_.published;
  ++period_.published;
  period_.processing_s += processing_s;
  if (stamp.isZero()) return;  // the sender sets no stamps
  ++period_.stamped;
  period_.age_s += age_s;
}

void FrameStatistics::setState(unsigned char level, const std::string& text, const std::string& silence)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  level_ = level;
  state_ = text;
  silence_ = silence;
}

void FrameStatistics::setRunning(const std::string& topic)
{
  setState(diagnostic_msgs::DiagnosticStatus::OK, "running on " + topic, "no frames on " + topic);
}

void FrameStatistics::setLacking(const std::string& lack, const std::string& topic)
{
  setState(diagnostic_msgs::DiagnosticStatus::WARN, logLine(lack), "no frames on " + topic);
}

void FrameStatistics::setIdle()
{
  setState(diagnostic_msgs::DiagnosticStatus::OK, "idle: nobody subscribes");
}

std::string FrameStatistics::setUnsubscribed(const std::string& reason)
{
  std::string what = "cannot subscribe: " + logLine(reason);
  setState(diagnostic_msgs::DiagnosticStatus::ERROR, what);
  return what;
}

void FrameStatistics::countUnshared(std::function<std::uint64_t()> unshared)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  unshared_ = std::move(unshared);
}

FrameStatistics::Totals FrameStatistics::totals()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return totals_;
}

/// Takes what there is to tell since the last report.
FrameStatistics::Report FrameStatistics::takeReport()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const Clock::time_point now = Clock::now();
  const bool is_silent = period_.received == 0 && waits_ && !silence_.empty();
  if (!is_silent)
  {
    last_active_ = now;
    silence_reported_ = false;
  }
  const bool is_late = now - last_active_ > kSilenceTimeout;
  Report report;
  report.period = std::exchange(period_, Period());
  report.seconds = std::chrono::duration<double>(now - report.period.begin).count();
  report.totals = totals_;
  report.level = is_silent ? static_cast<unsigned char>(diagnostic_msgs::DiagnosticStatus::WARN) : level_;
  report.state = is_silent ? silence_ : state_;
  report.becomes_late = is_late && !std::exchange(silence_reported_, true);
  report.last_error = last_error_;
  report.unshared = unshared_;
  return report;
}

void FrameStatistics::report(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const Report report = takeReport();
  if (report.becomes_late) ROS_WARN("%s for %ld s", report.state.c_str(), static_cast<long>(kSilenceTimeout.count()));
  const Period& period = report.period;
  const auto mean = [](double sum, std::uint64_t count)
  { return sum / static_cast<double>(std::max<std::uint64_t>(1, count)); };
  status.summary(report.level, report.state);
  if (period.refused > 0)
    status.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN, "%lu frames refused",
                         static_cast<unsigned long>(period.refused));
  status.addf("input rate (Hz)", "%.2f", static_cast<double>(period.received) / report.seconds);
  status.addf("output rate (Hz)", "%.2f", static_cast<double>(period.published) / report.seconds);
  status.addf("processing time (ms)", "%.3f", mean(period.processing_s, period.published) * 1e3);
  status.addf("output age (ms)", "%.3f", mean(period.age_s, period.stamped) * 1e3);
  status.add("frames received", report.totals.received);
  status.add("frames published", report.totals.published);
  status.add("frames dropped", report.totals.dropped);
  status.add("frames refused", report.totals.refused);
  if (report.unshared) status.add("frames not shared", report.unshared());
  status.add("last error", report.last_error);
}

FrameDiagnostics::FrameDiagnostics(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const std::string& name)
  : period_(readPeriod(pnh)), updater_(nh, pnh, name)
{
  updater_.setHardwareID("none");
  updater_.add("frames", [this](diagnostic_updater::DiagnosticStatusWrapper& status) { statistics_->report(status); });
  ros::NodeHandle guarded = nh;
  gate_.guard(guarded);
  const auto report = [this](const ros::WallTimerEvent&) { updater_.force_update(); };
  timer_ = guarded.createWallTimer(ros::WallDuration(period_), report);
}

FrameDiagnostics::~FrameDiagnostics()
{
  timer_.stop();  // while the gate passes that on to the queue, which would remember the timer for ever
  gate_.close();
}

}  // namespace robot_vision
