#include "road_model.hpp"
#include "scene_content.hpp"
#include "scene_model.hpp"
#include "scene_textures.hpp"

namespace robot_vision
{

struct RoadScene::Drive : Content
{
  explicit Drive(const SceneParams& params) : Content(params), still(params.still) {}

  scene::RoadPlace placeAt(double seconds) const { return scene::roadPlace(still ? 0.0 : seconds); }

  SceneTruth truth(double seconds) const override
  {
    const scene::Lens& lens = cameras.color();
    const scene::RoadPlace place = placeAt(seconds);
    const cv::Affine3d camera = scene::mountedCamera(place.robot), world_in_camera = camera.inv();
    scene::Polygon3 ahead = scene::laneAhead(place.along);
    for (cv::Point3d& point : ahead)
      point = world_in_camera * point;
    SceneObject lane;
    lane.name = "lane";
    lane.pose = world_in_camera * place.lane;
    lane.outline = scene::clipToImage(scene::project(scene::clipToView(ahead, lens), lens.camera, 1), lens.camera);
    lane.visible = !lane.outline.empty();  // it ends at the border of the image, and nothing covers it
    lane.center = lens.camera.project(cv::Point3d(lane.pose.translation()));
    return {0, camera, {lane}};
  }

  void draw(double seconds, const cv::Vec3d& offset, scene::Canvas& canvas) const override
  {
    const cv::Affine3d world = scene::mountedCamera(placeAt(seconds).robot).inv().translate(-offset);
    canvas.ground(scene::kGrass, scene::kSky, world);
    canvas.board(texture, world * board.pose, board.size);
  }

  bool still;
  scene::Board board = scene::onFloor(0.0, 0.0, scene::roadSize());
  scene::Texture texture = scene::imageTexture(scene::roadImage());
};

RoadScene::RoadScene(const SceneParams& params) : Scene(std::make_unique<const Drive>(params))
{
}

}  // namespace robot_vision
