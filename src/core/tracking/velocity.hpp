#pragma once

namespace robot_vision
{

constexpr double kMinInterval = 1e-3;  // s, the shortest time in which a velocity can be measured

}  // namespace robot_vision
