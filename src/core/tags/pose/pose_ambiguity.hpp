#pragma once

#include <vector>

#include "bundle_pose.hpp"

namespace robot_vision
{

/// Decides which of the two possible poses of a body is right in each frame, by the forward algorithm of a hidden
/// Markov model: from one frame to the next, the right pose turns little.
class PoseAmbiguity
{
public:
  /// The poses of a frame, the more probable one first. `elapsed` is the time (s) since the last frame; in `fits` the
  /// pose of the lower cost comes first; `weight` is the share of the costs that is new information, 0 to 1.
  std::vector<WeightedPose> update(double elapsed, const std::vector<PoseRefinement>& fits, double weight);

  void clear() { last_.clear(); }

private:
  std::vector<double> expected(double elapsed, const std::vector<PoseRefinement>& fits) const;

  std::vector<WeightedPose> last_;
};

}  // namespace robot_vision
