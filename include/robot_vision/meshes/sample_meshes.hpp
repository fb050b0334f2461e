#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// An axis through the middle of a mesh (the center of its MeshExtent) about which it looks the same when it is turned.
struct SampleSymmetry
{
  cv::Vec3d axis;  // of length 1, in the mesh's frame
  int fold;        // turns by multiples of 360 / fold degrees; 0: by any angle
};

/// A mesh that is made by formulas, closed, the same on every call. It stands on the plane z = 0 of its frame, z is up,
/// and the origin is below its body.
struct SampleMesh
{
  std::string name;
  Mesh mesh;
  std::vector<SampleSymmetry> symmetries;  // that neither its shape nor its colors break
};

/// The names of all, in alphabetical order: bottle, box, bracket, can, drill, duck, mug, nut.
const std::vector<std::string>& sampleMeshNames();

/// Throws std::invalid_argument for any other name.
SampleMesh sampleMesh(const std::string& name);

}  // namespace robot_vision
