#include "corner_noise.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{

namespace
{

const double kMemory = 1.0 - 1.0 / 300.0;  // weight of the statistics so far, from one frame to the next
const double kStateSize = 8.0;
const double kMinFreedom = 80.0;    // degrees of freedom needed to tell fresh and lasting noise apart
const double kSignificance = 3.0;   // standard deviations by which the total and the fresh noise must differ
const double kMinFreshShare = 0.1;  // least share of fresh noise while it is not known yet

}  // namespace

void CornerNoise::addResiduals(double squares, double freedom)
{
  squares_ = kMemory * squares_ + squares;
  freedom_ = kMemory * freedom_ + freedom;
}

void CornerNoise::addChange(double variance)
{
  change_squares_ = kMemory * change_squares_ + kStateSize * variance;
  change_freedom_ = kMemory * change_freedom_ + kStateSize;
}

double CornerNoise::fresh(double min_lasting) const
{
  const double all = total();
  return change_freedom_ < kMinFreedom ? std::max(all - min_lasting, kMinFreshShare * all)
                                       : std::min(all, change_squares_ / change_freedom_);
}

double CornerNoise::lasting(double min_lasting) const
{
  if (change_freedom_ < kMinFreedom) return min_lasting;
  const double all = total(), rest = all - fresh(min_lasting);
  const double doubt = all * std::sqrt(2.0 / freedom_ + 2.0 / change_freedom_);
  return rest > kSignificance * doubt ? std::max(rest, min_lasting) : min_lasting;
}

}  // namespace robot_vision
