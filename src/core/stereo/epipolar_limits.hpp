#pragma once

namespace robot_vision
{

constexpr double kMaxEpipolarDistance = 1.5;  // px, of a point that agrees with the line of its partner

}  // namespace robot_vision
