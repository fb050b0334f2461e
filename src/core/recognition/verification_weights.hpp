#pragma once

#include <array>

namespace robot_vision
{

/// Of the constant 1 and evidenceFeatures(), in their order.
using VerificationWeights = std::array<double, 10>;

// What the program fit_verification (test/benchmarks) printed for 24 frames.
constexpr VerificationWeights kColorAndDepthWeights = {-4.29, 3.35, -1.90, -1.56, 0.52, 2.86, 3.65, 7.58, 0.99, 2.56};
constexpr VerificationWeights kDepthWeights = {-3.42, 2.21, 0.38, -4.62, 1.90, 7.73, 0.00, 0.00, 0.00, 2.17};
// Not as it was printed: outlines count for more here and colors for less, or an object of a single color would be
// accepted where it is a tenth too far away.
constexpr VerificationWeights kColorWeights = {-1.9, 0.0, 0.0, 0.0, 0.0, 6.0, 0.8, 4.0, 1.5, 0.3};

}  // namespace robot_vision
