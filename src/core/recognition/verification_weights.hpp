#pragma once

#include <array>

namespace robot_vision
{

/// Of the constant 1 and evidenceFeatures(), in their order.
using VerificationWeights = std::array<double, 11>;

// What the program fit_verification (test/benchmarks) printed for 72 frames of each object, but for two numbers: what
// is sunken counts for about as much as it does without colors, -12.00 in place of -6.67 (and so the first number is
// -6.03 in place of -5.50), as few of the tables that it was fitted to have the color of an object.
constexpr VerificationWeights kColorAndDepthWeights = {-6.03, 4.34, -1.55, -12.00, -3.75, 0.25,
                                                       6.31,  2.92, 9.77,  1.10,   2.40};
// Of objects without colors, and of frames without. Their first numbers were printed as -6.80 and -3.33. They are lower
// because of all the poses that are tried in a frame, more are wrong than of those that they were fitted to: as they
// were printed, one of seven frames without the object had a false one, and one of eleven.
constexpr VerificationWeights kShapeWeights = {-8.40, 5.61, -4.86, -11.20, -3.31, 2.95, 11.93, 3.84, 0.00, 0.00, 3.45};
constexpr VerificationWeights kDepthWeights = {-4.10, 4.17, -2.81, -10.69, -4.27, 3.36, 7.60, 0.00, 0.00, 0.00, 2.74};
// Not as it was printed: outlines count for more here and colors for less, or an object of a single color would be
// accepted where it is a tenth too far away.
constexpr VerificationWeights kColorWeights = {-2.34, 0.0, 0.0, 0.0, 0.0, 0.0, 6.0, 0.8, 4.0, 1.5, 0.3};

}  // namespace robot_vision
