#pragma once

#include <string>

namespace robot_vision
{

/// What to do about a device file that cannot be used for this errno, to follow the system's reason: who may open it
/// (EACCES), who holds it (EBUSY); empty if there is nothing to say.
std::string accessAdvice(const std::string& path, int error);

}  // namespace robot_vision
