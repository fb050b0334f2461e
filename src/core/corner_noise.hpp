#pragma once

namespace robot_vision
{

/// The variance (px^2) of each coordinate of the corners that a camera sees, as measured over some ten seconds.
///
/// How badly corners fit together says all of it. How much they change while a tag is at rest says which part of it is
/// new in every frame: the rest, due to pixels and printers, does not average out.
class CornerNoise
{
public:
  /// px^2: all of it until something has been measured, and the least that stays.
  CornerNoise(double variance, double least_lasting)
    : squares_(kPriorFreedom * variance), freedom_(kPriorFreedom), least_lasting_(least_lasting)
  {
  }

  /// A sum of squared residuals and its degrees of freedom.
  void addResiduals(double squares, double freedom);

  /// The variance of eight coordinates at rest.
  void addChange(double variance);

  double total() const { return squares_ / freedom_; }
  double fresh() const;    // what is new in every frame
  double lasting() const;  // what stays

private:
  static constexpr double kPriorFreedom = 4.0;

  double squares_, freedom_, least_lasting_;
  double change_squares_ = 0.0, change_freedom_ = 0.0;
};

}  // namespace robot_vision
