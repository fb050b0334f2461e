#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

struct TextureParams
{
  std::string detector = "orb";
  int view_features = 500;
  int scales = 3;
  int min_views = 2;
  int max_points = 12000;
  int subdivisions = 2;
  int view_size = 300;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("detector", &TextureParams::detector, OneOf{"orb, sift or akaze"}, "", "what finds and describes keypoints");
    visit("view_features", &TextureParams::view_features, Range{50, 5000}, "",
          "most keypoints of a view, at each of its scales");
    visit("scales", &TextureParams::scales, Range{1, 4}, "",
          "of each view, the next one half as large; the first one is enlarged to view_size, at most twice");
    visit("min_views", &TextureParams::min_views, Range{1, 10}, "", "that a keypoint must be found in");
    visit("max_points", &TextureParams::max_points, Range{100, 50000}, "", "that are kept, those that most views have");
    visit("subdivisions", &TextureParams::subdivisions, Range{0, 3}, "",
          "of the icosahedron whose corners a mesh is looked at from: 12, 42, 162 or 642 directions");
    visit("view_size", &TextureParams::view_size, Range{60, 2000}, "px", "of the object's diameter in its views");
  }
};

/// Throws std::invalid_argument for the first parameter out of range, and for sift if this OpenCV has none.
void validate(const TextureParams& params);

/// A place on an object's surface that looks like nothing else on it.
struct TexturePoint
{
  cv::Vec3f position;   // m, in the object's frame
  cv::Vec3f direction;  // of length 1, in the object's frame: to the cameras that it was seen by, in the mean
  float size = 0.0F;    // m, diameter of the part of the surface that its descriptor is of
  int views = 0;        // that it was found in
};

/// An object as its keypoints, for a TextureMatcher. Made by TextureTrainer.
struct TextureModel
{
  static constexpr const char* kMethod = "TOD";

  TextureParams params;
  MeshExtent extent;
  int views = 0;  // that were learned
  std::vector<TexturePoint> points;
  cv::Mat descriptors;  // a row for each point: CV_8UC1, or CV_32FC1 of sift
};

constexpr int kMaxTexturePoints = 1000000;

/// Throws std::invalid_argument naming what no model can have.
void validate(const TextureModel& model);

/// The model as bytes that are the same on all machines; one whose training has not ended, too.
std::vector<std::uint8_t> toBytes(const TextureModel& model);

/// The inverse. Throws std::invalid_argument for bytes that are no such model: of another method, of a newer version,
/// cut, longer, or with numbers that no model can have.
TextureModel textureModelFromBytes(const std::uint8_t* bytes, std::size_t size);

}  // namespace robot_vision
