#pragma once

#include <apriltag/apriltag.h>

#include <memory>
#include <string>

namespace robot_vision
{

using FamilyPtr = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// The library's own record of a family.
/// Throws std::invalid_argument as tagFamily() does.
FamilyPtr makeFamily(const std::string& name);

}  // namespace robot_vision
