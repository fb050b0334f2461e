#pragma once

#include <string>

namespace robot_vision
{

/// Advice for a device file that cannot be used because of this errno, to be appended to the system's error text: who
/// may open it (EACCES, EPERM) or which processes have it open (EBUSY). Empty for other errors.
std::string accessAdvice(const std::string& path, int error);

}  // namespace robot_vision
