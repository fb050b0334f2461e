#pragma once

#include <cstdint>

#include "hsv_tests.hpp"

namespace robot_vision
{

constexpr std::uint8_t kUnsure = 1;

/// Puts 255, 0 or kUnsure into `mask` for `count` pixels of three bytes in the order that the hue limits have.
void applyTests(const HsvTests& tests, const std::uint8_t* pixels, int count, std::uint8_t* mask);

}  // namespace robot_vision
