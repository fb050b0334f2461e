#pragma once

namespace robot_vision
{

/// Measures, over some ten seconds, how many times larger the variance of the corners is than the stated variance.
///
/// The residuals of a pose's corners tell the whole noise. The change of the corners of a tag at rest tells the part
/// that is new in every frame ("fresh"). The rest ("lasting"), due to pixels and printers, does not average out.
class CornerNoise
{
public:
  /// `trust` is the weight of the stated variance, in degrees of freedom.
  explicit CornerNoise(double trust) : squares_(trust), freedom_(trust) {}

  /// Adds a sum of squared residuals, each divided by its stated variance, and the degrees of freedom of that sum.
  void addResiduals(double squares, double freedom);

  /// Adds the mean square change of the eight coordinates of a tag at rest, divided by their stated variance.
  void addChange(double variance);

  double total() const { return squares_ / freedom_; }
  double fresh(double min_lasting) const;    // at least `min_lasting` of the noise is lasting
  double lasting(double min_lasting) const;  // at least `min_lasting`

private:
  double squares_, freedom_;
  double change_squares_ = 0.0, change_freedom_ = 0.0;
};

}  // namespace robot_vision
