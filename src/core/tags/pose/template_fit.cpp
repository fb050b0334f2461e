#include "template_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace robot_vision
{

namespace
{

using Corners = std::array<cv::Point2d, 4>;
using Information = cv::Matx<double, kUnknowns, kUnknowns>;

constexpr double kInitialBlur = 0.7;  // px
constexpr double kMinBlur = 0.2;      // px; a pixel itself blurs more
constexpr int kMaxSteps = 30;
constexpr double kMinDamping = 1e-3;      // a few increases lead from there to one that shortens a step
constexpr double kMinGain = 0.3;          // of a step, in variances of a sample; a smaller gain ends the fit
constexpr double kMaxCornerShift = 0.4;   // cells, from where a corner was found
constexpr double kMaxResidual = 0.2;      // root mean square, relative to the contrast
constexpr double kRegularization = 1e-6;  // keeps unknowns on which no sample depends

/// The residuals of the samples at a view, with the derivatives of the gray levels by the unknowns.
struct Linearised
{
  std::vector<Unknowns> jacobian;
  std::vector<double> residuals;
  Information information;
  Unknowns gradient;
  double squares = 0.0;
};

constexpr std::size_t kBlock = 64;  // rows that are added line by line, as they stay in the nearest cache

/// Adds line kLine of the outer products of rows with themselves, from the diagonal on. The sums stay in registers, and
/// begin at an even number, as vectors have two.
template <int kLine>
void addLine(const Unknowns* begin, const Unknowns* end, Information& product)
{
  constexpr int kFirst = kLine / 2 * 2;
  std::array<double, kUnknowns - kFirst> sum;
  std::copy_n(&product(kLine, kFirst), sum.size(), sum.begin());
  for (const Unknowns* row = begin; row != end; ++row)
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] += row->val[kLine] * row->val[kFirst + i];
  std::copy(sum.begin(), sum.end(), &product(kLine, kFirst));
}

template <int... kLines>
void addLines(const Unknowns* begin, const Unknowns* end, Information& product, std::integer_sequence<int, kLines...>)
{
  (addLine<kLines>(begin, end, product), ...);
}

/// The sum of the outer products of all rows with themselves, which is symmetric.
Information productOf(const std::vector<Unknowns>& rows)
{
  Information product = Information::zeros();
  for (std::size_t i = 0; i < rows.size(); i += kBlock)
  {
    const Unknowns* const begin = rows.data() + i;
    addLines(begin, begin + std::min(kBlock, rows.size() - i), product, std::make_integer_sequence<int, kUnknowns>());
  }
  for (int line = 0; line < kUnknowns; ++line)
    for (int i = line + 1; i < kUnknowns; ++i)
      product(i, line) = product(line, i);
  return product;
}

/// Changes the equations so that their solution changes the blur by exactly `change`.
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
  TemplateFit(const TagTemplate& tag_template, const std::vector<GraySample>& samples, const Corners& corners)
    : template_(tag_template), cells_(tag_template.cells), samples_(samples)
  {
    const auto grays = std::minmax_element(samples.begin(), samples.end(),
                                           [](const GraySample& a, const GraySample& b) { return a.gray < b.gray; });
    view_.H = toTemplate(corners, tag_template);
    view_.appearance[kBlur] = kInitialBlur;
    view_.appearance[kBlack] = grays.first->gray;
    view_.appearance[kContrast] = view_.appearance[kAround] = grays.second->gray - grays.first->gray;
  }

  /// Fits the view to the samples; returns false if it does not converge.
  bool run()
  {
    double damping = kMinDamping;
    bool last_step_failed = false;  // after a failed step, a small step does not show that the fit has converged
    fit_ = linearise(view_);
    for (int step = 0; step < kMaxSteps; ++step)
    {
      const Unknowns by = nextStep(damping);
      if (!(by.dot(by) > 0.0)) return false;  // the equations have no solution
      const TagView next_view = movedView(view_, by);
      if (!last_step_failed && hasConverged(by.dot(fit_.gradient)))
      {
        view_ = next_view;  // the last gain is too small to compute the residuals once more
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
        // The position of sharp edges between pixels hardly shows: there, steps gain less than they promise.
        if (!last_step_failed && hasConverged(gain)) return true;
      }
      last_step_failed = !better;
    }
    return false;
  }

  Corners corners() const { return templateCorners(view_.H, template_); }

  bool isSimilar() const
  {
    const double residual = std::sqrt(fit_.squares / static_cast<double>(samples_.size()));
    return residual < kMaxResidual * view_.appearance[kContrast];
  }

  /// The covariance of the corners, from the residual of each sample, because samples near edges may fit less well than
  /// others (White: A Heteroskedasticity-Consistent Covariance Matrix Estimator, 1980).
  CornerCovariance covariance() const
  {
    const auto count = static_cast<double>(samples_.size());
    const double correction = count / (count - kUnknowns);  // the fit makes the residuals smaller than the noise
    std::vector<Unknowns> scores = fit_.jacobian;
    for (std::size_t i = 0; i < scores.size(); ++i)
      scores[i] *= correction * fit_.residuals[i];
    Information information = fit_.information;
    for (int i = 0; i < kUnknowns; ++i)
      information(i, i) += kRegularization;
    const Information inverse = information.inv(cv::DECOMP_CHOLESKY);
    const Information sum = inverse * productOf(scores) * inverse;
    const cv::Matx<double, 8, 8> by_homography = cornersByHomography(view_.H, corners());
    return by_homography * sum.get_minor<8, 8>(0, 0) * by_homography.t();
  }

private:
  bool hasConverged(double gain) const { return gain * static_cast<double>(samples_.size()) < kMinGain * fit_.squares; }

  /// The next step. If the blur would become smaller than the least one, it is the best step to the least blur.
  Unknowns nextStep(double damping) const
  {
    Information damped = fit_.information;
    for (int i = 0; i < kUnknowns; ++i)
      damped(i, i) += damping * damped(i, i) + kRegularization;
    const Unknowns by = damped.solve(fit_.gradient, cv::DECOMP_CHOLESKY);
    const double to_min = kMinBlur - view_.appearance[kBlur];
    if (by[kBlur] >= to_min) return by;
    Unknowns gradient = fit_.gradient;
    holdBlur(damped, gradient, to_min);
    return damped.solve(gradient, cv::DECOMP_CHOLESKY);
  }

  Linearised linearise(const TagView& view) const
  {
    Linearised sums;
    sums.jacobian.resize(samples_.size());
    sums.residuals.resize(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i)
    {
      Unknowns& J = sums.jacobian[i];
      const double residual = samples_[i].gray - grayAt(cells_, template_.cells.cols, view, samples_[i].position, J);
      sums.residuals[i] = residual;
      sums.squares += residual * residual;
      sums.gradient += residual * J;
    }
    sums.information = productOf(sums.jacobian);
    return sums;
  }

  const TagTemplate& template_;
  BlurredGrid cells_;
  const std::vector<GraySample>& samples_;
  TagView view_;
  Linearised fit_;  // at the view, or at the one before the last step
};

}  // namespace

std::optional<FittedCorners> fitTemplate(const TagTemplate& tag_template, const std::vector<GraySample>& samples,
                                         const Corners& corners)
{
  if (samples.size() < 4 * kUnknowns) return std::nullopt;
  TemplateFit fit(tag_template, samples, corners);
  if (!fit.run() || !fit.isSimilar()) return std::nullopt;
  const FittedCorners found{fit.corners(), fit.covariance()};
  const double max_shift =
      kMaxCornerShift * cv::norm(corners[2] - corners[0]) / std::sqrt(2.0) / tag_template.widthAtBorder();
  const bool is_near =
      std::equal(corners.begin(), corners.end(), found.corners.begin(),
                 [&](const cv::Point2d& a, const cv::Point2d& b) { return cv::norm(a - b) < max_shift; });
  return is_near ? std::make_optional(found) : std::nullopt;
}

}  // namespace robot_vision
