#include "robot_vision/recognition/symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core/affine.hpp>
#include <string>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxSymmetries = 20;
constexpr double kSameAxis = 0.1 * CV_PI / 180.0;  // rad
// Turns of an object differ by 3 degrees at least. A turn by half about an axis that is off moves others by twice that.
constexpr double kSameTurn = 1.0 * CV_PI / 180.0;

double angleOf(double cosine)
{
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

cv::Matx33d turn(const cv::Vec3d& axis, double angle)
{
  return cv::Affine3d(axis * angle, cv::Vec3d()).rotation();
}

/// Whether two directions are along the same line, but for a small angle.
bool isParallel(const cv::Vec3d& a, const cv::Vec3d& b, double angle)
{
  return cv::norm(a.cross(b)) < std::sin(angle);
}

cv::Vec3d checkedAxis(const Symmetry& symmetry)
{
  const double length = cv::norm(symmetry.axis);
  require(std::isfinite(length) && length > 0.0, "the axis of a symmetry",
          toText(symmetry.axis[0]) + ", " + toText(symmetry.axis[1]) + ", " + toText(symmetry.axis[2]),
          "a direction: finite, and not zero");
  require(symmetry.fold == 0 || (symmetry.fold >= 2 && symmetry.fold <= SymmetryGroup::kMaxTurns),
          "the fold of a symmetry", symmetry.fold,
          "0, for any angle, or from 2 to " + std::to_string(SymmetryGroup::kMaxTurns));
  return symmetry.axis / length;
}

/// The turn by half about any axis that is perpendicular to this one.
cv::Matx33d flip(const cv::Vec3d& axis)
{
  const cv::Vec3d other = std::abs(axis[0]) < 0.7 ? cv::Vec3d(1, 0, 0) : cv::Vec3d(0, 1, 0);
  return turn(cv::normalize(axis.cross(other)), CV_PI);
}

}  // namespace

double rotationAngle(const cv::Matx33d& rotation)
{
  return angleOf(0.5 * (cv::trace(rotation) - 1.0));
}

SymmetryGroup::SymmetryGroup() : turns_{cv::Matx33d::eye()}
{
}

SymmetryGroup::SymmetryGroup(const std::vector<Symmetry>& symmetries) : SymmetryGroup()
{
  require(symmetries.size() <= kMaxSymmetries, "the number of symmetries", static_cast<double>(symmetries.size()),
          "at most " + std::to_string(kMaxSymmetries));
  symmetries_ = symmetries;
  for (const Symmetry& symmetry : symmetries)
  {
    const cv::Vec3d axis = checkedAxis(symmetry);
    if (symmetry.fold > 0)
      turns_.push_back(turn(axis, 2.0 * CV_PI / symmetry.fold));
    else if (axis_ && !isParallel(*axis_, axis, kSameAxis))
      ball_ = true;
    else if (!axis_)
      axis_ = axis;
  }
  if (axis_) reduce();
  close();
}

/// Beside an axis with any angle only what turns the axis round adds anything.
void SymmetryGroup::reduce()
{
  bool turned = false;
  for (const cv::Matx33d& one : turns_)
  {
    require(ball_ || isParallel(one * *axis_, *axis_, kSameTurn), "the axis of a symmetry",
            "neither along nor across one with any angle",
            "along it or, with a fold of 2, across it: they do not belong to one object");
    turned = turned || axis_->dot(one * *axis_) < 0.0;
  }
  turns_ = {cv::Matx33d::eye()};
  if (turned && !ball_) turns_.push_back(flip(*axis_));
  if (ball_) axis_.reset();
}

/// Adds what the turns make one after the other, until nothing is new.
void SymmetryGroup::close()
{
  const std::vector<cv::Matx33d> generators(turns_.begin() + 1, turns_.end());
  turns_.resize(1);
  for (std::size_t i = 0; i < turns_.size(); ++i)
    for (const cv::Matx33d& generator : generators)
    {
      const cv::Matx33d product = generator * turns_[i];
      const bool known =
          std::any_of(turns_.begin(), turns_.end(),
                      [&](const cv::Matx33d& one) { return rotationAngle(one.t() * product) < kSameTurn; });
      if (!known) turns_.push_back(product);
      require(turns_.size() <= static_cast<std::size_t>(kMaxTurns),
              "the number of turns that the symmetries make together", "more than " + std::to_string(kMaxTurns),
              "less: their axes do not belong to one object");
    }
}

cv::Matx33d SymmetryGroup::nearest(const cv::Matx33d& rotation, const cv::Matx33d& reference) const
{
  if (ball_) return reference;
  cv::Matx33d best = rotation;
  double best_trace = -2.0;
  for (const cv::Matx33d& one : turns_)
  {
    cv::Matx33d equal = rotation * one;
    if (axis_)
    {
      const cv::Matx33d difference = reference.t() * equal;
      const cv::Vec3d& a = *axis_;
      const cv::Matx33d cross(0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0);
      const double along = a.dot(difference * a);
      equal = equal * turn(a, std::atan2(cv::trace(difference * cross), cv::trace(difference) - along));
    }
    const double trace = cv::trace(reference.t() * equal);
    if (trace > best_trace + 1e-12) best = equal;
    best_trace = std::max(best_trace, trace);
  }
  return best;
}

double SymmetryGroup::angle(const cv::Matx33d& a, const cv::Matx33d& b) const
{
  return rotationAngle(b.t() * nearest(a, b));
}

double SymmetryGroup::directionAngle(const cv::Vec3d& a, const cv::Vec3d& b) const
{
  if (ball_) return 0.0;
  double smallest = CV_PI;
  for (const cv::Matx33d& one : turns_)
  {
    const cv::Vec3d equal = one * b;
    const double angle = axis_ ? std::abs(angleOf(axis_->dot(a)) - angleOf(axis_->dot(equal))) : angleOf(a.dot(equal));
    smallest = std::min(smallest, angle);
  }
  return smallest;
}

}  // namespace robot_vision
