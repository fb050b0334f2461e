#include "capture_status.hpp"

namespace robot_vision
{

using diagnostic_msgs::DiagnosticStatus;

bool CaptureStatus::opened(const std::string& description)
{
  const bool is_new = description_ != description;
  description_ = description;
  statistics_.resumed();
  if (!lost_) statistics_.setState(DiagnosticStatus::OK, description_);
  return is_new;
}

void CaptureStatus::lost(const std::string& reason)
{
  lost_ = true;
  statistics_.setState(DiagnosticStatus::ERROR, reason);
}

bool CaptureStatus::streaming()
{
  const bool again = lost_;
  lost_ = false;
  statistics_.setState(DiagnosticStatus::OK, description_);
  return again;
}

bool CaptureStatus::idle()
{
  const bool again = lost_;
  lost_ = false;
  statistics_.setIdle();
  return again;
}

void CaptureStatus::stopped()
{
  statistics_.setState(DiagnosticStatus::OK, "stopped: ~start_capture starts it again");
}

void CaptureStatus::ended(const std::string& error)
{
  const bool good = error.empty();
  statistics_.setState(good ? DiagnosticStatus::OK : DiagnosticStatus::ERROR, good ? "the source has ended" : error);
}

}  // namespace robot_vision
