#include "capture_status.hpp"

#include <utility>

namespace robot_vision
{

using diagnostic_msgs::DiagnosticStatus;

bool CaptureStatus::opened(const std::string& description)
{
  const bool is_new = std::exchange(description_, description) != description;
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
  statistics_.setState(DiagnosticStatus::OK, description_);
  return std::exchange(lost_, false);
}

bool CaptureStatus::idle()
{
  statistics_.setIdle();
  return std::exchange(lost_, false);
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
