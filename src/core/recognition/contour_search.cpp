#include "contour_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr float kMinShare = 0.5F;  // of the squared gradient, that is along the normal: 45 degrees
constexpr double kNearness = 3.0;  // what is this part of the radius away counts half
constexpr int kMaxMixed = 2;       // px, beside an edge, whose depths can be of neither side

/// The gradient between pixels that are all within the image, by linear interpolation.
cv::Vec2f gradientAt(const cv::Mat& gradients, float x, float y)
{
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float right = x - static_cast<float>(column), down = y - static_cast<float>(row);
  const auto* const above = gradients.ptr<std::int16_t>(row) + 2 * column;
  const auto* const below = gradients.ptr<std::int16_t>(row + 1) + 2 * column;
  cv::Vec2f gradient;
  for (int i = 0; i < 2; ++i)
  {
    const auto a = static_cast<float>(above[i]), b = static_cast<float>(above[i + 2]);
    const auto c = static_cast<float>(below[i]), d = static_cast<float>(below[i + 2]);
    const float upper = a + right * (b - a), lower = c + right * (d - c);
    gradient[i] = upper + down * (lower - upper);
  }
  return gradient;
}

/// Where the largest of three values at -1, 0 and 1 is, by a parabola.
double peak(double before, double here, double behind)
{
  const double bend = before - 2.0 * here + behind;
  return bend < 0.0 ? std::clamp(0.5 * (before - behind) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace

std::optional<double> ContourSearch::colorEdge(const cv::Point2d& from, const cv::Vec2f& normal, int radius) const
{
  const cv::Mat& gradients = frame_.gradients();
  radius = std::min(radius, kMaxRadius);
  const auto x = static_cast<float>(from.x), y = static_cast<float>(from.y);
  const auto last_x = static_cast<float>(gradients.cols - 1), last_y = static_cast<float>(gradients.rows - 1);
  std::array<float, 2 * kMaxRadius + 3> slopes{};  // along the normal, from radius + 1 px before to as many behind
  std::array<bool, 2 * kMaxRadius + 3> is_along{};
  for (int i = 0; i < 2 * radius + 3; ++i)
  {
    const auto way = static_cast<float>(i - radius - 1);
    const float u = x + way * normal[0], v = y + way * normal[1];
    if (!(u >= 0.0F && v >= 0.0F && u < last_x && v < last_y)) continue;
    const cv::Vec2f gradient = gradientAt(gradients, u, v);
    const float along = gradient.dot(normal);
    slopes[static_cast<std::size_t>(i)] = std::abs(along);
    is_along[static_cast<std::size_t>(i)] = along * along >= kMinShare * gradient.dot(gradient);
  }
  double best = 0.0;
  std::optional<double> place;
  for (std::size_t i = 1; i < static_cast<std::size_t>(2 * radius + 2); ++i)
  {
    const auto before = static_cast<double>(slopes[i - 1]), here = static_cast<double>(slopes[i]),
               behind = static_cast<double>(slopes[i + 1]);
    if (!is_along[i] || here < min_gradient_ || here <= before || here < behind) continue;
    const double way = static_cast<double>(i) - radius - 1.0, part = kNearness * way / radius;
    const double quality = here / (1.0 + part * part);
    if (quality <= best) continue;
    best = quality;
    place = way + peak(before, here, behind);
  }
  return place;
}

float ContourSearch::depthAt(const cv::Point2d& place) const
{
  const cv::Mat& depth = frame_.depth();
  const bool is_inside =  // which a position is not whose rounding would overflow
      place.x > -0.5 && place.y > -0.5 && place.x < depth.cols - 0.5 && place.y < depth.rows - 0.5;
  if (!is_inside) return std::numeric_limits<float>::quiet_NaN();
  const int x = std::clamp(cvRound(place.x), 0, depth.cols - 1), y = std::clamp(cvRound(place.y), 0, depth.rows - 1);
  return depth.at<float>(y, x);
}

std::optional<double> ContourSearch::depthEdge(const cv::Point2d& from, const cv::Vec2f& normal, int radius,
                                               double depth, double gate) const
{
  std::optional<double> place;
  int last_inside = -kMaxRadius - kMaxMixed - 1;
  for (int way = -radius; way <= radius + kMaxMixed; ++way)
  {
    const auto z = static_cast<double>(
        depthAt({from.x + way * static_cast<double>(normal[0]), from.y + way * static_cast<double>(normal[1])}));
    if (std::abs(z - depth) < gate) last_inside = way;
    if (!(z > depth + gate) || way - last_inside > kMaxMixed) continue;
    const double middle = 0.5 * (last_inside + way);
    if (!place || std::abs(middle) < std::abs(*place)) place = middle;
  }
  return place;
}

}  // namespace robot_vision
