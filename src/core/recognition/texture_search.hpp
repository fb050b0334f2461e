#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <optional>
#include <vector>

#include "texture_match.hpp"

namespace robot_vision
{

struct TextureSearchParams
{
  int rounds;       // at most
  int min_inliers;  // that a pose must have
  double diameter;  // m, of the object
};

/// A pose of an object in the camera's optical frame, and the matches that agree with it.
struct TexturePose
{
  cv::Affine3d pose;
  std::vector<std::size_t> inliers;
};

/// Whether a match is where a pose has it, seen from a side from which it may look like that, and at the depth that is
/// seen, up to `depth_tolerance` (m) more than its noise.
bool agrees(const TextureMatch& match, const cv::Affine3d& pose, double depth_tolerance);

/// The indices of the matches among `candidates` that agree with a pose.
std::vector<std::size_t> inliersOf(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                                   const cv::Affine3d& pose, double depth_tolerance);

/// The pose by three of the candidates, which are near each other, that most of them agree with. None if these are
/// fewer than min_inliers. The same for the same random numbers.
std::optional<TexturePose> searchTexture(const std::vector<TextureMatch>& matches,
                                         const std::vector<std::size_t>& candidates, const TextureSearchParams& params,
                                         cv::RNG& random);

}  // namespace robot_vision
