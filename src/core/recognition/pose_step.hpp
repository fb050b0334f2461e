#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Where the anchor of a view is, and how the view is turned, in the camera's optical frame.
struct ViewPose
{
  cv::Matx33d rotation;
  cv::Vec3d anchor;  // m
};

/// The least squares of a small turn about the anchor of a view and a small shift of it.
class PoseStep
{
public:
  /// What moves by `direction` (of length 1) at `arm` (m) from the anchor is to move by `error` (m).
  void add(const cv::Vec3d& arm, const cv::Vec3d& direction, double error, double weight)
  {
    const double row[6] = {arm[1] * direction[2] - arm[2] * direction[1],
                           arm[2] * direction[0] - arm[0] * direction[2],
                           arm[0] * direction[1] - arm[1] * direction[0],
                           direction[0],
                           direction[1],
                           direction[2]};
    for (int i = 0; i < 6; ++i)
    {
      const double weighted = weight * row[i];
      for (int j = 0; j <= i; ++j)
        left_[i][j] += weighted * row[j];
      right_[i] += weighted * error;
    }
    spread_ += weight * arm.dot(arm);
    weight_ += weight;
  }

  /// Moves the pose; false: too little is known of it.
  bool apply(ViewPose& pose);

private:
  bool solve(double* step);

  double left_[6][6] = {};  // the lower half
  double right_[6] = {};
  double spread_ = 0.0, weight_ = 0.0;
};

}  // namespace robot_vision
