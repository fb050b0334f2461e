#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"
#include "robot_vision/scene/scene.hpp"

namespace robot_vision
{

constexpr double kSceneTableHeight = 0.72;   // m
const cv::Size2d kSceneTableSize(1.0, 0.7);  // m, to the left and forward
constexpr double kSceneTableDistance = 1.0;  // m forward to its middle

/// A mesh that stands on the table, with z of its frame up.
struct TabletopMesh
{
  std::string name;
  Mesh mesh;
};

/// All sample meshes of the package, by their names.
std::vector<TabletopMesh> sampleTabletop();

/// A table in the room, with meshes standing on it. The camera moves slowly around it, 40 degrees to both sides, and
/// looks down on it. The objects of the truth are the meshes, in the order given:
///
/// - A pose is that of the mesh's own frame.
/// - An outline has the corners of the convex hull of the mesh's silhouette. Lenses bend the lines between them.
///
/// The lowest point of each mesh is on the table; where it is and how far it is turned about z follow from the order
/// and the sizes.
class TabletopScene : public Scene
{
public:
  static constexpr std::size_t kMaxMeshes = 50;
  static constexpr double kMaxHeight = 0.5;  // m; what is taller would be beside or behind the camera in some frames

  /// The parameter `still` has the camera stay where it is in frame 0. Throws std::invalid_argument as
  /// validate(SceneParams) and validate(Mesh) do, naming the mesh, for less than one mesh or more than kMaxMeshes, for
  /// names that are empty or not unique, for a mesh taller than kMaxHeight, and if there is no room on the table.
  explicit TabletopScene(const SceneParams& params, const std::vector<TabletopMesh>& meshes = sampleTabletop());

private:
  struct Table;
};

}  // namespace robot_vision
