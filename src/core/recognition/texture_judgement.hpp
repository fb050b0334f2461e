#pragma once

#include <vector>

#include "robot_vision/recognition/texture_matcher.hpp"
#include "texture_fit.hpp"

namespace robot_vision
{

/// What there is to say of a fit among candidates; `model` is the object's index, the rest its extent.
TexturedObject judgeTexture(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                            const TextureFit& fit, int model, const MeshExtent& extent, const CameraModel& camera);

}  // namespace robot_vision
