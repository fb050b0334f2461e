#include "corner_noise.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{

namespace
{

const double kKept = 1.0 - 1.0 / 300.0;  // of what is known, from one frame to the next
const double kCoordinates = 8.0;
const double kFewest = 80.0;  // degrees of freedom to tell the parts of the noise from each other
const double kCertain = 3.0;  // standard deviations by which they differ then

}  // namespace

void CornerNoise::addResiduals(double squares, double freedom)
{
  squares_ = kKept * squares_ + squares;
  freedom_ = kKept * freedom_ + freedom;
}

void CornerNoise::addChange(double variance)
{
  change_squares_ = kKept * change_squares_ + kCoordinates * variance;
  change_freedom_ = kKept * change_freedom_ + kCoordinates;
}

double CornerNoise::fresh() const
{
  return change_freedom_ < kFewest ? total() : std::min(total(), change_squares_ / change_freedom_);
}

double CornerNoise::lasting() const
{
  const double all = total(), rest = all - fresh();
  const double doubt = all * std::sqrt(2.0 / freedom_ + 2.0 / std::max(change_freedom_, kFewest));
  return rest > kCertain * doubt ? rest : 0.0;
}

}  // namespace robot_vision
