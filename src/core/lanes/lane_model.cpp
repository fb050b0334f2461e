#include "lane_model.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision::lanes
{
namespace
{

constexpr int kIterations = 8;         // of Gauss-Newton; it is at the end after some four
constexpr double kOffsetWeight = 1.0;  // against confidence: the lane around the robot is meant

/// A place in the frame of the lane: along its tangent and to the left of it, where the robot is beside its middle.
cv::Point2d inLane(const LaneModel& lane, const cv::Point2d& place)
{
  const double cosine = std::cos(lane.heading), sine = std::sin(lane.heading);
  return {cosine * place.x - sine * place.y, sine * place.x + cosine * place.y + lane.offset};
}

/// The distance of a place from the lane's middle (m, to its left positive), and its derivative with respect to offset,
/// heading, curvature and width.
double besideMiddle(const LaneModel& lane, const cv::Point2d& place, cv::Vec4d& derivative)
{
  const cv::Point2d at = inLane(lane, place);
  const double k = lane.curvature, square = at.x * at.x + at.y * at.y;
  const double root = std::max(std::hypot(k * at.x, 1.0 - k * at.y), 1e-9);
  const double beside = (2.0 * at.y - k * square) / (1.0 + root);  // the same as (1 - root) / k, also for k = 0
  const double along_u = -k * at.x / root, along_v = (1.0 - k * at.y) / root;
  const double root_by_k = (k * square - at.y) / root;
  derivative = {along_v, along_v * at.x - along_u * (at.y - lane.offset), -(square + beside * root_by_k) / (1.0 + root),
                0.0};
  return beside;
}

/// The same of the nearest place of a line.
double besideMiddle(const LaneModel& lane, const LineFit& line)
{
  cv::Vec4d unused;
  return besideMiddle(lane, {line.from, line.y(line.from)}, unused);
}

/// Adds what the places of a line tell of the measures; `side` is 1 for the left line and -1 for the right one.
void addLine(const LaneModel& lane, const LineFit& line, double side, cv::Matx44d& normal, cv::Vec4d& right)
{
  for (const cv::Point2d& place : line.places)
  {
    cv::Vec4d derivative;
    const double error = besideMiddle(lane, place, derivative) - side * lane.width / 2.0;
    derivative[3] = -side / 2.0;
    normal += derivative * derivative.t();
    right -= error * derivative;
  }
}

/// The measures by the parabolas, from which the arcs are found.
LaneModel initialLane(const LanePair& pair, double width)
{
  LaneModel lane;
  double lines = 0.0, ahead = 0.0;
  for (const LineFit* line : {pair.left, pair.right})
  {
    if (!line) continue;
    lines += 1.0;
    lane.heading -= std::atan(line->slope(0.0));
    lane.curvature += 2.0 * line->c[2] / std::pow(std::hypot(1.0, line->slope(0.0)), 3);
    ahead += line->y(0.0) * std::cos(std::atan(line->slope(0.0))) + (line == pair.left ? -1.0 : 1.0) * width / 2.0;
  }
  lane.heading /= lines;
  lane.curvature /= lines;
  lane.offset = -ahead / lines;
  lane.width = width;
  return lane;
}

bool isWidth(double width, const LaneParams& params)
{
  return std::abs(width / params.lane_width - 1.0) <= params.width_tolerance;
}

/// Whether two fits are parallel, and as far apart as the lines of a lane.
bool areLane(const LineFit& left, const LineFit& right, const LaneParams& params)
{
  const double begin = std::max(left.from, right.from), end = std::min(left.to, right.to);
  for (const double x : {begin, (begin + end) / 2.0, end})
    if (!isWidth((left.y(x) - right.y(x)) / std::hypot(1.0, (left.slope(x) + right.slope(x)) / 2.0), params))
      return false;
  return true;
}

/// Whether a single line is more likely the left one than the right one.
bool isLeft(const LineFit& line, const LaneParams& params, const std::optional<LaneModel>& last)
{
  const bool is_at_left = line.y(line.from) > 0.0;  // of the robot
  if (!last) return is_at_left;
  const double beside = besideMiddle(*last, line);
  return std::abs(beside) < params.lane_width ? beside > 0.0 : is_at_left;
}

}  // namespace

cv::Point2d LaneModel::middle(double along) const
{
  // The chord of the arc has the direction of its middle.
  const double half = curvature * along / 2.0;
  const double chord = std::abs(half) < 1e-6 ? along : along * std::sin(half) / half;
  const double x = chord * std::cos(half), y = chord * std::sin(half) - offset;
  const double cosine = std::cos(heading), sine = std::sin(heading);
  return {cosine * x + sine * y, cosine * y - sine * x};
}

bool mayBeOf(const LaneModel& last, const LineFit& line)
{
  return std::abs(besideMiddle(last, line)) < last.width;
}

LanePair choosePair(const std::vector<LineFit>& fits, const LaneParams& params, const std::optional<LaneModel>& last)
{
  LanePair best;
  double best_score = -1.0;
  for (const LineFit& left : fits)
    for (const LineFit& right : fits)
    {
      if (&left == &right || !areLane(left, right, params)) continue;
      const double offset = std::abs(initialLane({&left, &right}, params.lane_width).offset) / params.lane_width;
      const double score = left.confidence + right.confidence - kOffsetWeight * offset;
      if (best.left && score <= best_score) continue;
      best = {&left, &right};
      best_score = score;
    }
  if (best.left || fits.empty()) return best;
  const auto surest = std::max_element(fits.begin(), fits.end(),
                                       [](const auto& a, const auto& b) { return a.confidence < b.confidence; });
  if (isLeft(*surest, params, last)) return {&*surest, nullptr};
  return {nullptr, &*surest};
}

std::optional<LaneModel> fitLane(const LanePair& pair, double width, const LaneParams& params)
{
  if (!pair.left && !pair.right) return {};
  LaneModel lane = initialLane(pair, width);
  for (int i = 0; i < kIterations; ++i)
  {
    cv::Matx44d normal = cv::Matx44d::zeros();
    cv::Vec4d right, step;
    if (pair.left) addLine(lane, *pair.left, 1.0, normal, right);
    if (pair.right) addLine(lane, *pair.right, -1.0, normal, right);
    if (!pair.left || !pair.right)  // One line tells nothing of the width, which stays.
    {
      for (int j = 0; j < 4; ++j)
        normal(3, j) = normal(j, 3) = j == 3 ? 1.0 : 0.0;
      right[3] = 0.0;
    }
    if (!cv::solve(normal, right, step, cv::DECOMP_SVD)) return {};
    lane.offset += step[0];
    lane.heading += step[1];
    lane.curvature += step[2];
    lane.width += step[3];
  }
  // NaN is refused by each of these comparisons.
  const bool is_lane = isWidth(lane.width, params) && std::abs(lane.curvature) <= params.max_curvature &&
                       std::abs(lane.heading) < CV_PI / 2.0 && std::isfinite(lane.offset);
  if (!is_lane) return {};
  return lane;
}

}  // namespace robot_vision::lanes
