#pragma once

#include <vector>

#include "bundle_pose.hpp"

namespace robot_vision
{

/// Which of the two poses that a body may have in each frame is the right one: the forward algorithm of a hidden Markov
/// model, in which a right pose goes over into one that is turned in nearly the same way.
class PoseAmbiguity
{
public:
  /// The poses of a frame, the more probable one first. `passed`: s since the last frame; `fits`: that of the least
  /// cost first; `share`: of what the costs say that is new, 0 to 1.
  std::vector<WeighedPose> update(double passed, const std::vector<PoseRefinement>& fits, double share);

  void clear() { last_.clear(); }

private:
  std::vector<double> expected(double passed, const std::vector<PoseRefinement>& fits) const;

  std::vector<WeighedPose> last_;
};

}  // namespace robot_vision
