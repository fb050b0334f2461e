#pragma once

#include <array>

namespace robot_vision
{

/// Of the constant 1 and evidenceFeatures(), in their order.
using VerificationWeights = std::array<double, 10>;

// What the program fit_verification (test/benchmarks) printed for 144 frames of each object.
constexpr VerificationWeights kColorAndDepthWeights = {-5.42, 4.74, -2.85, -4.28, -0.18, 5.61, 3.49, 11.76, 0.83, 3.56};
// Its first number was printed as -3.21. It is lower because more of the poses that are tried in a frame without colors
// are wrong than of those that it was fitted to: with -3.21 a fifth of the frames of other seeds had a false object.
constexpr VerificationWeights kDepthWeights = {-4.30, 2.66, -0.79, -6.57, 8.23, 8.71, 0.00, 0.00, 0.00, 3.12};
// Not as it was printed: outlines count for more here and colors for less, or an object of a single color would be
// accepted where it is a tenth too far away.
constexpr VerificationWeights kColorWeights = {-2.34, 0.0, 0.0, 0.0, 0.0, 6.0, 0.8, 4.0, 1.5, 0.3};

}  // namespace robot_vision
