#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Pairs rows with columns so that the sum of the pairs' gains is the largest there is. Each row and each column is in
/// one pair at most. A pair whose gain is not above 0 is never made.
///
/// Returns the column of each row, -1 for a row without one. Throws std::invalid_argument for a gain that is NaN or not
/// from -1e12 to 1e12.
///
/// Rows and columns that no chain of gains above 0 connects are solved apart, each such part by shortest augmenting
/// paths (Jonker, Volgenant: A Shortest Augmenting Path Algorithm for Dense and Sparse Linear Assignment Problems,
/// Computing 38, 1987). A part of n rows and m columns takes a time that grows as n m min(n, m).
std::vector<int> bestAssignment(const cv::Mat_<double>& gains);

}  // namespace robot_vision
