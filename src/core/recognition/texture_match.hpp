#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "descriptor_index.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "robot_vision/recognition/texture_matcher.hpp"
#include "robot_vision/recognition/texture_model.hpp"

namespace robot_vision
{

/// What a camera sees, for those who look for textures.
struct SeenImage
{
  cv::Mat gray;
  cv::Mat metres;  // depths of its pixels; empty: none
  cv::Mat mask;    // not 0 where keypoints count; empty: everywhere
  const CameraModel* camera = nullptr;

  double focal() const { return std::sqrt(camera->K(0, 0) * camera->K(1, 1)); }
};

/// Keypoints of an image that count, in its px, with a row of descriptors for each.
struct ImageTexture
{
  std::vector<cv::KeyPoint> keys;
  cv::Mat descriptors;
  float smallest = 0.0F;  // px, of the smallest one
};

/// Finds the keypoints of an image, which is enlarged for it if it is small.
ImageTexture textureOf(const SeenImage& image, const std::string& detector, const TextureMatchParams& params);

/// A keypoint of an image that looks like a place of an object.
struct TextureMatch
{
  cv::Point2d pixel;
  cv::Point2d ray;               // x / z and y / z of what is seen there, in the camera's optical frame
  double tolerance = 0.0;        // of the ray, up to which it is where it should be
  double distance = 0.0;         // m, along z, by how large the keypoint is
  double depth = 0.0;            // m, NaN if there is none
  double depth_deviation = 0.0;  // m, of its noise
  cv::Vec3d point;               // m, of the object, in its frame
  cv::Vec3d direction;           // from which the object looks like that, in its frame

  bool hasDepth() const { return depth > 0.0; }
};

/// A model, ready to be compared with images.
class TextureIndex
{
public:
  explicit TextureIndex(const TextureModel& model);

  const TextureModel& model() const { return model_; }

  /// Gives keypoints to the places of the model that look most like them, unless another place looks nearly so, too.
  std::vector<TextureMatch> match(const SeenImage& image, const ImageTexture& texture, const TextureMatchParams& params,
                                  const DepthErrorParams& errors);

private:
  struct IndexPair
  {
    int key;    // of the image
    int point;  // of the model
  };

  std::vector<IndexPair> pairs(const ImageTexture& texture, double ratio);

  TextureModel model_;
  DescriptorIndex index_;
};

}  // namespace robot_vision
