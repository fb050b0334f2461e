#pragma once

#include <string>
#include <vector>

#include "robot_vision/scene/tabletop_scene.hpp"

namespace robot_vision
{

/// The meshes of a list, and what there is to say of those that come from files: their units, and what is odd.
struct SceneMeshes
{
  std::vector<TabletopMesh> meshes;
  std::string remarks;
};

/// Reads the meshes of a list such as "mug, /home/me/coke.stl": names of sample meshes, and files. They are named by
/// their files, with _ for what no tf frame may have, and a number behind the second of a name. An empty list is all
/// samples. Throws SourceError naming the mesh that cannot be read.
SceneMeshes readSceneMeshes(const std::string& list);

}  // namespace robot_vision
