#include "line_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace robot_vision::lanes
{
namespace
{

constexpr int kTrials = 60;      // with half of the places wrong, all fail with a probability of 0.0003
constexpr int kRefinements = 3;  // least squares of the places that fit
constexpr std::size_t kMinPlaces = 8;
constexpr std::uint64_t kSeed = 0x1a9e5;  // the same frame has the same answer
constexpr double kFullyPainted = 3.0;     // a line of which a third is painted counts as whole

/// The parabola with the least squared error in y, about the middle of the x.
cv::Vec3d leastSquares(const Places& places)
{
  double middle = 0.0;
  for (const cv::Point2d& place : places)
    middle += place.x / static_cast<double>(places.size());
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Vec3d right;
  for (const cv::Point2d& place : places)
  {
    const double x = place.x - middle;
    const cv::Vec3d row(1.0, x, x * x);
    normal += row * row.t();
    right += place.y * row;
  }
  cv::Vec3d c;
  if (!cv::solve(normal, right, c, cv::DECOMP_SVD)) return {};
  return {c[0] - middle * (c[1] - middle * c[2]), c[1] - 2.0 * middle * c[2], c[2]};
}

Places within(const Places& places, const LineFit& fit, double tolerance)
{
  Places close;
  for (const cv::Point2d& place : places)
    if (std::abs(place.y - fit.y(place.x)) <= tolerance * std::hypot(1.0, fit.slope(place.x))) close.push_back(place);
  return close;
}

bool isPlausible(const LineFit& fit, double x, double max_curvature)
{
  const double root = std::hypot(1.0, fit.slope(x));
  return std::abs(2.0 * fit.c[2]) <= max_curvature * root * root * root;
}

/// RANSAC: the places that the best of many parabolas through three of them fits. `places` are sorted by x.
Places consensus(const Places& places, const LaneParams& params)
{
  cv::RNG random(kSeed);
  const auto third = static_cast<int>(places.size()) / 3;
  Places best;
  for (int trial = 0; trial < kTrials; ++trial)
  {
    Places sample;
    for (const int begin : {0, third, 2 * third})
      sample.push_back(places[static_cast<std::size_t>(begin + random.uniform(0, third))]);
    const double gap = std::min(sample[1].x - sample[0].x, sample[2].x - sample[1].x);
    if (gap < params.min_length / 10.0) continue;
    LineFit fit;
    fit.c = leastSquares(sample);
    if (!isPlausible(fit, sample[1].x, params.max_curvature)) continue;
    Places close = within(places, fit, params.tolerance);
    if (close.size() > best.size()) best = std::move(close);
  }
  return best;
}

/// At most kMaxPlaces of the middles on the floor, sorted by x.
Places onFloor(const Places& middles, const GroundView& view)
{
  Places places;
  const std::size_t step = middles.size() / kMaxPlaces + 1;
  for (std::size_t i = 0; i < middles.size(); i += step)
    places.push_back(view.toGround(middles[i]));
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  return places;
}

/// The share of the visible part of a curve between its ends, and the share of that piece that is painted.
cv::Vec2d sharesSeen(const LineFit& fit, const Places& close, const GroundView& view)
{
  const cv::Mat& seen = view.seen();
  std::vector<bool> painted(static_cast<std::size_t>(seen.rows), false);
  for (const cv::Point2d& place : close)
    painted[static_cast<std::size_t>(std::clamp(cvRound(view.toView(place).y), 0, seen.rows - 1))] = true;
  double visible = 0.0, between = 0.0, both = 0.0;  // rows
  for (int row = 0; row < seen.rows; ++row)
  {
    const double x = view.toGround({0.0, static_cast<double>(row)}).x;
    const int column = cvRound(std::clamp(view.toView({x, fit.y(x)}).x, -1.0, 1.0 * seen.cols));
    if (column < 0 || column >= seen.cols || !seen.at<unsigned char>(row, column)) continue;
    visible += 1.0;
    if (x < fit.from || x > fit.to) continue;
    between += 1.0;
    if (painted[static_cast<std::size_t>(row)]) both += 1.0;
  }
  return {between / std::max(visible, 1.0), both / std::max(between, 1.0)};
}

/// The share of places that fit, without those that would if they were anywhere in the window.
double moreThanChance(std::size_t fit, std::size_t all, const LaneParams& params)
{
  const double chance = std::min(2.0 * params.tolerance / params.window_width, 1.0);
  const double share = static_cast<double>(fit) / static_cast<double>(all);
  return std::max(share - chance, 0.0) / std::max(1.0 - chance, 1e-9);
}

}  // namespace

std::optional<LineFit> fitLine(const Places& middles, const GroundView& view, const LaneParams& params)
{
  const Places places = onFloor(middles, view);
  if (places.size() < kMinPlaces || places.back().x - places.front().x < params.min_length) return {};
  LineFit fit;
  fit.places = consensus(places, params);
  for (int i = 0; i < kRefinements; ++i)
  {
    if (fit.places.size() < kMinPlaces) return {};
    fit.c = leastSquares(fit.places);
    fit.places = within(places, fit, params.tolerance);
  }
  if (fit.places.size() < kMinPlaces) return {};
  fit.from = fit.places.front().x;
  fit.to = fit.places.back().x;
  if (fit.length() < params.min_length) return {};
  if (!isPlausible(fit, (fit.from + fit.to) / 2.0, params.max_curvature)) return {};
  const double inliers = moreThanChance(fit.places.size(), places.size(), params);
  const cv::Vec2d shares = sharesSeen(fit, fit.places, view);
  fit.confidence = inliers * shares[0] * std::min(1.0, kFullyPainted * shares[1]);
  if (fit.confidence < params.min_confidence) return {};
  return fit;
}

}  // namespace robot_vision::lanes
