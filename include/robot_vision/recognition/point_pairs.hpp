#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/meshes/mesh.hpp"
#include "robot_vision/recognition/pose_candidate.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

struct PointPairParams
{
  double sampling = 0.05;
  int angle_steps = 24;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("sampling", &PointPairParams::sampling, Range{0.02, 0.3}, "",
          "distance between points of a surface, and the step of distances, as share of the diameter");
    visit("angle_steps", &PointPairParams::angle_steps, Range{8, 120}, "", "steps of angles in a full turn");
  }
};

/// Points all over the surface of an object, whose pairs a PointPairMatcher knows it by. In the mesh's frame.
struct PointPairModel
{
  static constexpr const char* kMethod = "PPF";

  PointPairParams params;
  MeshExtent extent;
  std::vector<cv::Vec3f> points;   // m
  std::vector<cv::Vec3f> normals;  // of length 1
};

/// Samples the surface of a mesh, the same each time. Throws std::invalid_argument for a parameter out of range, as
/// validate(Mesh) does, and for a mesh without any extent.
PointPairModel trainPointPairs(const Mesh& mesh, const PointPairParams& params = PointPairParams());

/// Throws std::invalid_argument naming what no model can have.
void validate(const PointPairModel& model);

/// The model as bytes that are the same on all machines.
std::vector<std::uint8_t> toBytes(const PointPairModel& model);

/// The inverse. Throws std::invalid_argument for bytes that are no such model: of another method, of a newer version,
/// cut, longer, or with numbers that no model can have.
PointPairModel pointPairModelFromBytes(const std::uint8_t* bytes, std::size_t size);

struct PointPairMatchParams
{
  int reference_step = 2;
  int max_references = 1500;
  int max_points = 6000;
  double max_plane = 1.4;
  int max_candidates = 30;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("reference_step", &PointPairMatchParams::reference_step, Range{1, 1000}, "",
          "each one of so many points of the frame is tried to be on the object");
    visit("max_references", &PointPairMatchParams::max_references, Range{1, 100000}, "", "of them, at most");
    visit("max_points", &PointPairMatchParams::max_points, Range{10, 1000000}, "",
          "of the frame that are paired with them, at most");
    visit("max_plane", &PointPairMatchParams::max_plane, Range{0, 1000}, "",
          "extent of a plane, in diameters, from which it is no part of the object; 0: planes are not looked for");
    visit("max_candidates", &PointPairMatchParams::max_candidates, Range{1, 1000}, "",
          "of each model that are told, those with most votes");
  }
};

/// Finds where objects may be in the depths of frames, by features of point pairs: the distance of two points, and the
/// angles of their normals to the line between them and to each other. Neither texture nor views of the object are
/// needed.
///
/// Each pair of a reference point of the frame and another one votes for the points of the model, and angles about
/// their normals, that it may be. The poses with most votes that are near each other are one candidate. Memory is kept
/// from call to call. For one thread at a time.
///
/// Source: Drost, Ulrich, Navab, Ilic: Model Globally, Match Locally: Efficient and Robust 3D Object Recognition, CVPR
/// 2010.
class PointPairMatcher
{
public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PointPairMatcher(const PointPairMatchParams& params = PointPairMatchParams());
  ~PointPairMatcher();

  /// Adds a model, whose index is returned: 0, 1, ... Its pairs are put in order, which takes some 0.1 s. Throws
  /// std::invalid_argument as validate() of the model does.
  int add(const PointPairModel& model);

  /// The candidates for all models, those of each the best first. Empty without depths. Throws std::invalid_argument if
  /// nothing was set in the frame.
  std::vector<PoseCandidate> match(const RecognitionFrame& frame);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
