#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/meshes/mesh.hpp"
#include "robot_vision/recognition/symmetry.hpp"

namespace robot_vision
{

struct ViewParams
{
  int subdivisions = 2;
  int turns = 32;
  int contour_features = 64;
  int inner_features = 32;
  int surface_features = 64;
  double distance = 0.8;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("subdivisions", &ViewParams::subdivisions, Range{0, 3}, "",
          "of the icosahedron whose corners an object is looked at from: 12, 42, 162 or 642 directions");
    visit("turns", &ViewParams::turns, Range{4, 128}, "", "about the line of sight, of each direction");
    visit("contour_features", &ViewParams::contour_features, Range{32, 256}, "",
          "of a view, where something farther away begins");
    visit("inner_features", &ViewParams::inner_features, Range{0, 256}, "", "of a view, edges and texture inside it");
    visit("surface_features", &ViewParams::surface_features, Range{32, 256}, "", "of a view, normals of its surface");
    visit("distance", &ViewParams::distance, Range{0.05, 20}, "m",
          "of the object in its views, or two and a half times its radius: others look the same but for perspective");
  }
};

enum class FeatureKind : std::uint8_t
{
  kContour,  // an edge of the object, with something behind it that is farther away
  kInner,    // an edge or texture on its surface
  kSurface,  // its surface, away from edges
};

/// Something that a view shows at a place, in the camera's optical frame of the view, whose z is the line of sight.
struct ViewFeature
{
  std::int16_t x = 0, y = 0, z = 0;  // from the view's anchor, right, down and away, in steps of ViewModel::step()
  FeatureKind kind = FeatureKind::kContour;
  std::int8_t a = 0;  // of an edge: the direction across it, from x to y, in 128ths of a half turn, 0 to 127;
  std::int8_t b = 0;  // of a surface: x and y of its normal, of length 1, to the camera, in 127ths
};

/// What an object looks like from one direction. The camera looks at the anchor, a point of the object's surface well
/// inside its outline.
struct View
{
  cv::Vec3d rotation;                 // rad, of the object in the camera's optical frame, as a rotation vector
  cv::Vec3d center;                   // m, of the object's middle from the anchor, in the camera's optical frame
  cv::Rect2d box;                     // m, around the object at the anchor's distance, from the anchor
  double spin = 0.0;                  // rad, see ViewDirection
  int parent = -1;                    // a view before it, see ViewDirection
  std::vector<ViewFeature> features;  // those of one kind one after the other, each kind from what is well spread to
                                      // what lies between
};

constexpr int kMaxViews = 2000;

/// An object as its views, for an ObjectMatcher. Made by ViewTrainer. A view holds for any distance of the object and,
/// turned about the line of sight, for each of its turns: these are the templates.
struct ViewModel
{
  static constexpr const char* kMethod = "views";

  ViewParams params;
  std::vector<Symmetry> symmetries;
  MeshExtent extent;
  std::vector<int> levels;  // how many views there are of each level of the ViewTree, together with those above
  std::vector<View> views;  // less than those of all levels: training has not ended

  bool isComplete() const { return !levels.empty() && views.size() == static_cast<std::size_t>(levels.back()); }

  /// m, of the places of features.
  double step() const { return extent.radius / 8192.0; }

  /// How many templates it has: its views with all their turns.
  std::size_t templates() const;

  /// Bytes of memory that it takes.
  std::size_t memory() const;
};

/// The number of different turns of a view among those of a full one.
int turnsOf(const View& view, const ViewParams& params);

/// Throws std::invalid_argument naming what no model can have.
void validate(const ViewModel& model);

/// The model as bytes that are the same on all machines; one whose training has not ended, too.
std::vector<std::uint8_t> toBytes(const ViewModel& model);

/// The inverse. Throws std::invalid_argument for bytes that are no such model: of another method, of a newer version,
/// cut, longer, or with numbers that no model can have.
ViewModel viewModelFromBytes(const std::uint8_t* bytes, std::size_t size);

}  // namespace robot_vision
