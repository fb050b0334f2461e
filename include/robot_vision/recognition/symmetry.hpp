#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace robot_vision
{

/// A turn about an axis through the middle of an object (the center of its MeshExtent) that nobody can see.
struct Symmetry
{
  cv::Vec3d axis{0.0, 0.0, 1.0};  // in the object's frame, of any length
  int fold = 0;                   // turns by multiples of 360 / fold degrees, 2 to 120; 0: by any angle
};

/// All turns of an object that its symmetries make together. Never changes: threads may share it.
class SymmetryGroup
{
public:
  static constexpr int kMaxTurns = 120;

  /// Only the turn by nothing.
  SymmetryGroup();

  /// Axes that are less than 0.1 degrees apart are one. Throws std::invalid_argument naming an axis that is not finite
  /// or zero, a fold that cannot be, more than 20 symmetries, and axes that do not belong to one object: such that make
  /// more than kMaxTurns turns together, and such that are neither along one with any angle nor, with a fold of 2,
  /// across it. Two axes with any angle make all turns: the object is a ball.
  explicit SymmetryGroup(const std::vector<Symmetry>& symmetries);

  const std::vector<Symmetry>& symmetries() const { return symmetries_; }

  /// The turns, the one by nothing first; of those by any angle about axis() only one for each way that they leave it.
  const std::vector<cv::Matx33d>& turns() const { return turns_; }

  /// The axis, of length 1, about which any angle is allowed.
  const std::optional<cv::Vec3d>& axis() const { return axis_; }

  bool isBall() const { return ball_; }

  /// Of the rotations of the object that look like `rotation` the one nearest to `reference`.
  cv::Matx33d nearest(const cv::Matx33d& rotation, const cv::Matx33d& reference) const;

  /// The angle (rad) between two rotations of the object, as far as one can see it.
  double angle(const cv::Matx33d& a, const cv::Matx33d& b) const;

  /// The angle (rad) between two directions, of length 1, that the object is looked at from, as far as one can see it.
  double directionAngle(const cv::Vec3d& a, const cv::Vec3d& b) const;

private:
  void close();
  void reduce();

  std::vector<Symmetry> symmetries_;
  std::vector<cv::Matx33d> turns_;
  std::optional<cv::Vec3d> axis_;
  bool ball_ = false;
};

/// The angle (rad) of a rotation.
double rotationAngle(const cv::Matx33d& rotation);

}  // namespace robot_vision
