#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/recognition/texture_model.hpp"
#include "texture_search.hpp"

namespace robot_vision
{

/// A pose that was fitted to all matches that agree with it.
struct TextureFit
{
  TexturePose found;
  cv::Matx66d covariance;        // as in TexturedObject
  double depth_agreement = 0.0;  // likewise
  double probability = 1.0;      // that it is this one of the two poses that a plane may have
};

/// Fits a pose, and again, until the same of the candidates agree with it. If they are on a plane it is tilted to the
/// other side, too, which looks nearly the same: then there are two, the more probable one first. `depth_bias` (m) is
/// the standard deviation of what all depths have in common.
std::vector<TextureFit> fitTexture(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                                   const TexturePose& first, const MeshExtent& extent, double depth_bias);

}  // namespace robot_vision
