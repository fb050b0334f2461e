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
const double kMin = 0.1;      // share of the noise that is new in every frame, as long as nothing is known of it

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

double CornerNoise::fresh(double least_lasting) const
{
  const double all = total();
  return change_freedom_ < kFewest ? std::max(all - least_lasting, kMin * all)
                                   : std::min(all, change_squares_ / change_freedom_);
}

double CornerNoise::lasting(double least_lasting) const
{
  if (change_freedom_ < kFewest) return least_lasting;
  const double all = total(), rest = all - fresh(least_lasting);
  const double doubt = all * std::sqrt(2.0 / freedom_ + 2.0 / change_freedom_);
  return rest > kCertain * doubt ? std::max(rest, least_lasting) : least_lasting;
}

}  // namespace robot_vision
