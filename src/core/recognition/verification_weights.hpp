#pragma once

#include <array>

namespace robot_vision
{

/// Of the constant 1 and evidenceFeatures(), in their order.
using VerificationWeights = std::array<double, 10>;

// What the program fit_verification (test/benchmarks) printed for 48 frames.
constexpr VerificationWeights kColorAndDepthWeights = {-4.04, 4.08, -2.29, -3.98, 0.11, 3.78, 3.36, 8.88, 1.06, 2.68};
constexpr VerificationWeights kDepthWeights = {-2.47, 3.20, -1.05, -6.10, 4.88, 7.50, 0.00, 0.00, 0.00, 2.35};
// Not as it was printed: outlines count for more here and colors for less, or an object of a single color would be
// accepted where it is a tenth too far away.
constexpr VerificationWeights kColorWeights = {-1.9, 0.0, 0.0, 0.0, 0.0, 6.0, 0.8, 4.0, 1.5, 0.3};

}  // namespace robot_vision
