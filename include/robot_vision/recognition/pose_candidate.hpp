#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

namespace robot_vision
{

/// Where an object may be, as a matcher has found it in an image: near enough (some 10 degrees, 15 mm) for what
/// refines it, but not verified.
struct PoseCandidate
{
  int model = 0;       // index of the model, in the order in which the matcher was given them
  cv::Affine3d pose;   // of the object's frame, that of its mesh, in the camera's optical frame, m
  double score = 0.0;  // 0 to 1, how much of the view the image shows there, to compare candidates by
  cv::Rect box;        // px, around the object as that view has it; may reach out of the image
  int view = 0;        // index of the view of that model that looks most alike
};

}  // namespace robot_vision
