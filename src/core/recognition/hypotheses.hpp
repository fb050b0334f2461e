#pragma once

#include <vector>

#include "coarse_check.hpp"
#include "robot_vision/recognition/object_recognizer.hpp"

namespace robot_vision
{

/// A candidate that may be worth to be refined.
struct Hypothesis
{
  cv::Affine3d first;     // of the candidate
  cv::Affine3d pose;      // that, or one near it that agrees better with some depths
  bool is_moved = false;  // whether it is another one
  cv::Vec3d center;       // m, of the mesh
  double quality = 0.0;   // the more the better
  double rank = 0.0;      // the more the sooner it is tried
  double score = 0.0;     // of the candidate
  double pixels = 0.0;    // px^2 of the image that agree with its depths, where those were compared
};

/// The hypotheses of one model, the best first, and why there are no others.
class Hypotheses
{
public:
  Hypotheses(const DepthErrorParams& errors, double search) : coarse_(errors, search) {}

  /// Looks at the candidates of a model, the best first; notes in the report what is wrong with them.
  const std::vector<Hypothesis>& select(const RecognitionFrame& frame, const ObjectShape& shape,
                                        const std::vector<PoseCandidate>& candidates, ModelReport& report);

private:
  void look(const RecognitionFrame& frame, const ObjectShape& shape, const PoseCandidate& candidate,
            ModelReport& report);
  bool isNew(const Hypothesis& hypothesis, const MeshExtent& extent) const;

  CoarseCheck coarse_;
  std::vector<Hypothesis> found_, different_;
};

}  // namespace robot_vision
