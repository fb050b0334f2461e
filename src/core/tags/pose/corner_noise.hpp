#pragma once

namespace robot_vision
{

/// How many times larger the variance of the corners that a camera sees is than it was said to be, as measured over
/// some ten seconds.
///
/// How badly corners fit together says all of it. How much they change while a tag is at rest says which part of it is
/// new in every frame: the rest, due to pixels and printers, does not average out.
class CornerNoise
{
public:
  /// `trust`: degrees of freedom that what is said is worth.
  explicit CornerNoise(double trust) : squares_(trust), freedom_(trust) {}

  /// A sum of squared residuals by their variances, and its degrees of freedom.
  void addResiduals(double squares, double freedom);

  /// The mean square of what eight coordinates at rest change by, by their variance.
  void addChange(double variance);

  double total() const { return squares_ / freedom_; }
  double fresh(double least_lasting) const;    // what is new in every frame; `least_lasting`: the least that stays
  double lasting(double least_lasting) const;  // what stays

private:
  double squares_, freedom_;
  double change_squares_ = 0.0, change_freedom_ = 0.0;
};

}  // namespace robot_vision
