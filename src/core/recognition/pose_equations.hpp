#pragma once

#include <cmath>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// The weight of a residual, in standard deviations, by Tukey: what is beyond kTukey is none of what is fitted.
constexpr double kTukey = 4.685;  // 95 % as efficient as least squares
inline double tukeyWeight(double residual)
{
  const double share = residual / kTukey, rest = 1.0 - share * share;
  return rest > 0.0 ? rest * rest : 0.0;
}

/// What such a residual costs; kMaxTukeyCost beyond kTukey.
constexpr double kMaxTukeyCost = kTukey * kTukey / 6.0;
inline double tukeyCost(double residual)
{
  const double share = residual / kTukey, rest = 1.0 - share * share;
  return rest > 0.0 ? kMaxTukeyCost * (1.0 - rest * rest * rest) : kMaxTukeyCost;
}

/// The sums that a small motion of a body follows from (rigid_motion.hpp): residual - a . motion is to be small.
class PoseEquations
{
public:
  /// A residual whose standard deviation is `deviation`, in the same unit; `share` of it is independent of the others.
  /// It changes by -direction . shift of the point, which is at `lever` (m) from the body's origin.
  void add(const cv::Vec3d& direction, const cv::Vec3d& lever, double residual, double deviation, double share)
  {
    const cv::Vec3d turn = lever.cross(direction);
    addRow({direction[0], direction[1], direction[2], turn[0], turn[1], turn[2]}, residual, deviation, share);
  }

  /// The same of one that changes by -a . motion.
  void addRow(const cv::Vec6d& a, double residual, double deviation, double share)
  {
    const double normalized = residual / deviation, weight = tukeyWeight(normalized) * share;
    cost_ += tukeyCost(normalized) * share;
    shares_ += share;
    if (weight == 0.0) return;
    const double scale = weight / (deviation * deviation);
    for (int row = 0; row < 6; ++row)
    {
      const double scaled = scale * a[row];
      gradient_[row] += scaled * residual;
      for (int column = 0; column <= row; ++column)
        information_(row, column) += scaled * a[column];
    }
    weights_ += weight;
    squares_ += weight * normalized * normalized;
    ++count_;
  }

  /// What should have been seen, and was not.
  void addMissing(double share)
  {
    cost_ += kMaxTukeyCost * share;
    shares_ += share;
  }

  cv::Matx66d information() const
  {
    cv::Matx66d all = information_;
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < row; ++column)
        all(column, row) = all(row, column);
    return all;
  }

  const cv::Vec6d& gradient() const { return gradient_; }
  double cost() const { return cost_; }
  int count() const { return count_; }  // of residuals that have a weight

  /// 0 to 1: how much of what should have been seen was, and how near to where it should be.
  double quality() const { return shares_ > 0.0 ? 1.0 - cost_ / (kMaxTukeyCost * shares_) : 0.0; }

  /// The variance of the normalized residuals; 1 if they are as large as their standard deviations say.
  double variance() const { return weights_ > 0.0 ? squares_ / (kTukeyVariance * weights_) : 1.0; }

private:
  static constexpr double kTukeyVariance = 0.828;  // of normal residuals as they are weighted

  cv::Matx66d information_ = cv::Matx66d::zeros();  // its lower half
  cv::Vec6d gradient_;
  double cost_ = 0.0, shares_ = 0.0, weights_ = 0.0, squares_ = 0.0;
  int count_ = 0;
};

}  // namespace robot_vision
