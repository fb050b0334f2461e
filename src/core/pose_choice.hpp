#pragma once

#include <vector>

#include "pose_fit.hpp"

namespace robot_vision
{

/// Which of the two poses that a body may have in each frame is the right one: the forward algorithm of a hidden Markov
/// model, in which a right pose goes over into one that is turned in nearly the same way.
class PoseChoice
{
public:
  /// The probabilities of the poses in a frame, which sum to 1. `passed`: s since the last frame; `share`: of what
  /// the costs say that is new, 0 to 1.
  std::vector<double> update(double passed, const std::vector<PoseFit>& fits, double share);

  void clear() { last_.clear(); }

private:
  struct Weighed
  {
    PoseFit fit;
    double probability;
  };
  std::vector<double> expected(double passed, const std::vector<PoseFit>& fits) const;

  std::vector<Weighed> last_;
};

}  // namespace robot_vision
