#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/recognition/texture_model.hpp"
#include "robot_vision/recognition/texture_trainer.hpp"

namespace robot_vision
{

/// Keypoints of an object, with a row of descriptors for each.
struct TextureKeypoints
{
  std::vector<TexturePoint> points;
  cv::Mat descriptors;
};

/// The keypoints of a view whose surroundings are on the object, and have a depth. Throws std::invalid_argument naming
/// what is wrong with the view.
TextureKeypoints textureKeypoints(const TextureView& view, const TextureParams& params);

}  // namespace robot_vision
