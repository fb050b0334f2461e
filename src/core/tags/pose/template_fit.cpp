#include "template_fit.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{

namespace
{

using Corners = std::array<cv::Point2d, 4>;
using Information = cv::Matx<double, kUnknowns, kUnknowns>;

constexpr double kFirstBlur = 0.7;  // px
constexpr double kMinBlur = 0.2;    // px: a pixel itself blurs more
constexpr int kMaxSteps = 30;
constexpr double kMinDamping = 1e-3;  // few steps from where it shortens one
constexpr double kSettled = 0.3;      // what the last step gains, by the variance of a sample
constexpr double kFarthest = 0.4;     // cells, from where a corner was found
constexpr double kMaxUnlike = 0.2;    // of the contrast, root mean square
constexpr double kTiny = 1e-6;        // so that what does not show stays

/// The pixels by the unknowns at a view.
struct Linearised
{
  std::vector<Unknowns> jacobian;
  std::vector<double> residuals;
  Information information;
  Unknowns gradient;
  double squares = 0.0;
};

/// The sum of the outer products of all rows with themselves: a line of it at a time, which stays in registers.
Information productOf(const std::vector<Unknowns>& rows)
{
  Information product;
  for (int line = 0; line < kUnknowns; ++line)
  {
    std::array<double, kUnknowns> sum = {};
    for (const Unknowns& row : rows)
      for (std::size_t i = 0; i < kUnknowns; ++i)
        sum[i] += row[line] * row.val[i];
    std::copy(sum.begin(), sum.end(), &product(line, 0));
  }
  return product;
}

/// Has the equations say that the blur changes by so much, whatever the samples say.
void holdBlur(Information& information, Unknowns& gradient, double change)
{
  for (int i = 0; i < kUnknowns; ++i)
  {
    gradient[i] -= change * information(i, kBlur);
    information(i, kBlur) = information(kBlur, i) = 0.0;
  }
  information(kBlur, kBlur) = 1.0;
  gradient[kBlur] = change;
}

class TemplateFit
{
public:
  TemplateFit(const Pattern& pattern, const std::vector<GreySample>& samples, const Corners& corners)
    : pattern_(pattern), cells_(pattern.cells), samples_(samples)
  {
    const auto levels = std::minmax_element(samples.begin(), samples.end(),
                                            [](const GreySample& a, const GreySample& b) { return a.level < b.level; });
    view_.H = toPattern(corners, pattern);
    view_.looks[kBlur] = kFirstBlur;
    view_.looks[kBlack] = levels.first->level;
    view_.looks[kContrast] = view_.looks[kAround] = levels.second->level - levels.first->level;
  }

  /// False if it comes to no end.
  bool run()
  {
    double damping = kMinDamping;
    bool damped_more = false;  // a small step is then no sign of the end
    fit_ = linearise(view_);
    for (int step = 0; step < kMaxSteps; ++step)
    {
      const Unknowns by = stepBy(damping);
      if (!(by.dot(by) > 0.0)) return false;  // it cannot be solved
      const View next_view = movedView(view_, by);
      if (!damped_more && isSettled(by.dot(fit_.gradient)))
      {
        view_ = next_view;  // what it gains is not worth another look at the samples
        return true;
      }
      Linearised next = linearise(next_view);
      const double gain = fit_.squares - next.squares;
      const bool better = gain > 0.0;
      damping = better ? std::max(0.1 * damping, kMinDamping) : 10.0 * damping;
      if (better)
      {
        view_ = next_view;
        fit_ = std::move(next);
        // Edges between pixels that nothing blurs hardly show where they are: each step promises more than it gains.
        if (!damped_more && isSettled(gain)) return true;
      }
      damped_more = !better;
    }
    return false;
  }

  Corners corners() const { return patternCorners(view_.H, pattern_); }

  bool isLike() const
  {
    const double unlike = std::sqrt(fit_.squares / static_cast<double>(samples_.size()));
    return unlike < kMaxUnlike * view_.looks[kContrast];
  }

  /// By what each sample is off: edges may be less like the pattern than what lies between them (White: A
  /// Heteroskedasticity-Consistent Covariance Matrix Estimator, 1980).
  CornerCovariance covariance() const
  {
    const auto count = static_cast<double>(samples_.size());
    const double missed = count / (count - kUnknowns);  // samples are less off than they would be without them
    std::vector<Unknowns> off = fit_.jacobian;
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] *= missed * fit_.residuals[i];
    Information information = fit_.information;
    for (int i = 0; i < kUnknowns; ++i)
      information(i, i) += kTiny;
    const Information inverse = information.inv(cv::DECOMP_CHOLESKY);
    const Information sum = inverse * productOf(off) * inverse;
    const cv::Matx<double, 8, 8> by_homography = cornersByHomography(view_.H, corners());
    return by_homography * sum.get_minor<8, 8>(0, 0) * by_homography.t();
  }

private:
  bool isSettled(double gain) const { return gain * static_cast<double>(samples_.size()) < kSettled * fit_.squares; }

  /// Where the blur would become less than the least, the best step to where it is that.
  Unknowns stepBy(double damping) const
  {
    Information damped = fit_.information;
    for (int i = 0; i < kUnknowns; ++i)
      damped(i, i) += damping * damped(i, i) + kTiny;
    const Unknowns by = damped.solve(fit_.gradient, cv::DECOMP_CHOLESKY);
    const double to_least = kMinBlur - view_.looks[kBlur];
    if (by[kBlur] >= to_least) return by;
    Unknowns gradient = fit_.gradient;
    holdBlur(damped, gradient, to_least);
    return damped.solve(gradient, cv::DECOMP_CHOLESKY);
  }

  Linearised linearise(const View& view) const
  {
    Linearised sums;
    sums.jacobian.resize(samples_.size());
    sums.residuals.resize(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i)
    {
      Unknowns& J = sums.jacobian[i];
      const double residual = samples_[i].level - levelAt(cells_, pattern_.cells.cols, view, samples_[i].place, J);
      sums.residuals[i] = residual;
      sums.squares += residual * residual;
      sums.gradient += residual * J;
    }
    sums.information = productOf(sums.jacobian);
    return sums;
  }

  const Pattern& pattern_;
  BlurredGrid cells_;
  const std::vector<GreySample>& samples_;
  View view_;
  Linearised fit_;  // at the view, or where its last step began
};

}  // namespace

std::optional<FittedPattern> fitPattern(const Pattern& pattern, const std::vector<GreySample>& samples,
                                        const Corners& corners)
{
  if (samples.size() < 4 * kUnknowns) return std::nullopt;
  TemplateFit fit(pattern, samples, corners);
  if (!fit.run() || !fit.isLike()) return std::nullopt;
  const FittedPattern found{fit.corners(), fit.covariance()};
  const double farthest = kFarthest * cv::norm(corners[2] - corners[0]) / std::sqrt(2.0) / pattern.widthAtBorder();
  const bool is_near =
      std::equal(corners.begin(), corners.end(), found.corners.begin(),
                 [&](const cv::Point2d& a, const cv::Point2d& b) { return cv::norm(a - b) < farthest; });
  return is_near ? std::make_optional(found) : std::nullopt;
}

}  // namespace robot_vision
