#include "robot_vision/scene/tabletop_scene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>

#include "core/meshes/used_vertices.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "scene_content.hpp"
#include "scene_model.hpp"
#include "scene_textures.hpp"
#include "tabletop_model.hpp"

namespace robot_vision
{
namespace
{

/// A mesh on the table.
struct Standing
{
  Standing(const TabletopMesh& one)
  try : name(one.name), renderer(one.mesh), vertices(usedVertices(one.mesh))
  {
    const MeshExtent& extent = renderer.extent();
    for (const cv::Vec3d& vertex : vertices)
      radius = std::max(radius, std::hypot(vertex[0] - extent.center[0], vertex[1] - extent.center[1]));
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument("mesh " + printable(one.name) + ": " + e.what());
  }

  void stand(const cv::Point2d& place, double turn)
  {
    const MeshExtent& extent = renderer.extent();
    const double lowest = extent.center[2] - extent.size[2] / 2.0;
    const cv::Affine3d below(cv::Matx33d::eye(), cv::Vec3d(extent.center[0], extent.center[1], lowest));
    pose = cv::Affine3d(cv::Vec3d(0, 0, turn), cv::Vec3d(place.x, place.y, kSceneTableHeight)) * below.inv();
  }

  std::string name;
  MeshRenderer renderer;
  std::vector<cv::Vec3d> vertices;  // those that are seen
  double radius = 0.0;              // m, around its middle seen from above
  cv::Affine3d pose;                // in the world
};

void requireNames(const std::vector<TabletopMesh>& meshes)
{
  require(!meshes.empty() && meshes.size() <= TabletopScene::kMaxMeshes, "the number of meshes",
          static_cast<double>(meshes.size()), "from 1 to " + std::to_string(TabletopScene::kMaxMeshes));
  std::set<std::string> names;
  for (const TabletopMesh& mesh : meshes)
    require(!mesh.name.empty() && names.insert(mesh.name).second, "the name of a mesh",
            "'" + printable(mesh.name) + "'", "one that no other mesh has, and not empty");
}

/// The corners of the hull of what a camera without distortion would see, as the lens shows them.
scene::Polygon2 outlineOf(const std::vector<cv::Vec3d>& vertices, const cv::Affine3d& pose, const CameraModel& camera)
{
  std::vector<cv::Point2f> rays, hull;
  rays.reserve(vertices.size());
  for (const cv::Vec3d& vertex : vertices)
  {
    const cv::Vec3d point = pose * vertex;
    rays.emplace_back(point[0] / point[2], point[1] / point[2]);
  }
  cv::convexHull(rays, hull);
  scene::Polygon2 outline;
  for (const cv::Point2f& ray : hull)
    outline.push_back(camera.project({ray.x, ray.y, 1.0}));
  return outline;
}

}  // namespace

struct TabletopScene::Table : Content
{
  Table(const SceneParams& params, const std::vector<TabletopMesh>& meshes) : Content(params), still(params.still)
  {
    requireNames(meshes);
    std::vector<double> radii;
    for (const TabletopMesh& mesh : meshes)
    {
      standing.emplace_back(mesh);
      const double height = std::round(1000.0 * standing.back().renderer.extent().size[2]) / 1000.0;  // m
      require(height <= kMaxHeight, "mesh " + printable(mesh.name), toText(height) + " m tall",
              "at most " + toText(kMaxHeight) + " m");
      radii.push_back(standing.back().radius);
    }
    const std::vector<cv::Point2d> places = scene::placesOnTable(radii);
    if (places.size() < standing.size())
      require(false, "mesh " + printable(standing[places.size()].name),
              toText(std::round(200.0 * radii[places.size()]) / 100.0) + " m across",
              "small enough for the room that is left on the table");
    const double turn = 2.4;  // rad, from one to the next
    for (std::size_t i = 0; i < standing.size(); ++i)
      standing[i].stand(places[i], turn * static_cast<double>(i));
    fillRoom();
  }

  void fillRoom()
  {
    const scene::Room room = scene::buildRoom();
    items = {{scene::imageTexture(scene::floorImage(room.floor.size)), room.floor},
             {scene::imageTexture(scene::wallImage(room.back_wall.size, 1.0)), room.back_wall},
             {scene::imageTexture(scene::wallImage(room.left_wall.size, 0.86)), room.left_wall},
             {scene::imageTexture(scene::wallImage(room.right_wall.size, 0.92)), room.right_wall}};
    for (const scene::Board& skirting : room.skirting)
      items.push_back({scene::imageTexture(scene::plainImage(skirting.size, 0.004, {206, 216, 220})), skirting});
    for (const scene::Board& side : scene::tableSides())
      items.push_back({scene::imageTexture(scene::plainImage(side.size, 0.004, {60, 84, 104})), side});
    items.push_back({scene::imageTexture(scene::tableImage(kSceneTableSize)), scene::tableTop()});
  }

  cv::Affine3d cameraAt(double seconds) const { return scene::tabletopCamera(still ? 0.0 : seconds); }

  SceneTruth truth(double seconds) const override
  {
    const CameraModel& camera = cameras.color().camera;
    SceneTruth truth;
    truth.camera = cameraAt(seconds);
    const cv::Affine3d world = truth.camera.inv();
    std::vector<double> distances;
    for (const Standing& one : standing)
    {
      SceneObject object;
      object.name = one.name;
      object.pose = world * one.pose;
      object.outline = outlineOf(one.vertices, object.pose, camera);
      object.center = camera.project(cv::Point3d(object.pose.translation()));
      distances.push_back(cv::norm(object.pose * one.renderer.extent().center));
      truth.objects.push_back(object);
    }
    for (std::size_t i = 0; i < truth.objects.size(); ++i)
      truth.objects[i].visible = isVisible(i, truth.objects, distances);
    return truth;
  }

  bool isVisible(std::size_t one, const std::vector<SceneObject>& all, const std::vector<double>& distances) const
  {
    if (!scene::insideImage(all[one].outline, cameras.color().camera)) return false;
    for (std::size_t other = 0; other < all.size(); ++other)
      if (distances[other] < distances[one] && scene::overlap(all[one].outline, all[other].outline)) return false;
    return true;
  }

  void draw(double seconds, const cv::Vec3d& offset, scene::Canvas& canvas) const override
  {
    const cv::Vec3d to_light(-0.45, 0.45, 0.77);  // in the world
    const cv::Affine3d world = cameraAt(seconds).inv().translate(-offset);
    canvas.background({140, 165, 178});
    for (const Item& item : items)
      canvas.board(item.texture, world * item.board.pose, item.board.size);
    std::vector<scene::PlacedMesh> placed;
    for (const Standing& one : standing)
    {
      const double widened = 2.6 * one.radius;
      const cv::Vec3d place = one.pose * one.renderer.extent().center;
      const scene::Board shade = scene::onFloor(place[0], place[1], {widened, widened}, kSceneTableHeight);
      canvas.shadow(shadow, world * shade.pose, shade.size);
      placed.push_back({&one.renderer, world * one.pose});
    }
    canvas.meshes(placed, world.rotation() * to_light);
  }

  struct Item
  {
    scene::Texture texture;
    scene::Board board;
  };

  bool still;
  std::vector<Standing> standing;
  std::vector<Item> items;  // from the back to the front
  scene::Texture shadow = scene::imageTexture(scene::shadowDisc(150.0));
};

std::vector<TabletopMesh> sampleTabletop()
{
  std::vector<TabletopMesh> meshes;
  for (const std::string& name : sampleMeshNames())
    meshes.push_back({name, sampleMesh(name).mesh});
  return meshes;
}

TabletopScene::TabletopScene(const SceneParams& params, const std::vector<TabletopMesh>& meshes)
  : Scene(std::make_unique<const Table>(params, meshes))
{
}

}  // namespace robot_vision
