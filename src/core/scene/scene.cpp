#include "robot_vision/scene/scene.hpp"

#include <stdexcept>
#include <utility>

#include "calibration_poses.hpp"
#include "road_model.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/common/shared_instance.hpp"
#include "scene_noise.hpp"
#include "scene_renderer.hpp"
#include "scene_truth.hpp"

namespace robot_vision
{

void validate(const SceneParams& params)
{
  checkFields(params);
  const double narrowest = 3;
  require(params.width <= narrowest * params.height, "width", params.width, "at most 3 times the height");
  require(params.height <= narrowest * params.width, "height", params.height, "at most 3 times the width");
}

namespace
{

const double kPoseTime = 0.5;                 // s, how long each pose of the checkerboard is shown
const cv::Scalar kBackground(128, 140, 146);  // gray, far from the checkerboard's black and white
const cv::Size2d kInnerCorners(7.0 * kSceneCheckerSquare, 5.0 * kSceneCheckerSquare);

/// The renderer of a poster. Scenes without a poster share one, because building it takes a while.
std::shared_ptr<const scene::SceneRenderer> rendererFor(const cv::Mat& poster)
{
  if (!poster.empty() && poster.type() != CV_8UC3) throw std::invalid_argument("poster must be an 8-bit BGR image");
  if (!poster.empty()) return std::make_shared<const scene::SceneRenderer>(poster);
  return sharedInstance<const scene::SceneRenderer>();
}

}  // namespace

/// What a scene shows, and the camera that sees it.
struct Scene::Content
{
  explicit Content(const SceneParams& params)
    : rate((validate(params), params.rate)),
      lens(scene::sceneCamera(params.width, params.height)),
      noise(params.noise, params.seed, 3 * params.width)
  {
  }
  virtual ~Content() = default;

  /// The truth at a time of the motion (s), without the number of the frame.
  virtual SceneTruth truth(double seconds) const = 0;

  /// Draws an image of the camera's size, without the noise.
  virtual void paint(double seconds, cv::Mat& bgr) const = 0;

  double rate;
  scene::Lens lens;
  scene::PixelNoise noise;
};

struct Scene::Room : Content
{
  Room(const SceneParams& params, const cv::Mat& poster)
    : Content(params), still(params.still), renderer(rendererFor(poster))
  {
  }

  cv::Affine3d cameraAt(double seconds) const { return scene::cameraPose(still ? 0.0 : seconds); }

  SceneTruth truth(double seconds) const override
  {
    return scene::truthAt(seconds, cameraAt(seconds), renderer->posterAspect(), lens);
  }

  void paint(double seconds, cv::Mat& bgr) const override { renderer->paint(seconds, cameraAt(seconds), lens, bgr); }

  bool still;
  std::shared_ptr<const scene::SceneRenderer> renderer;
};

struct CalibrationScene::ShownBoard : Content
{
  using Content::Content;

  cv::Affine3d poseAt(double seconds) const
  {
    return scene::shownBoard(static_cast<int>(seconds / kPoseTime), size, lens.camera);
  }

  SceneTruth truth(double seconds) const override
  {
    SceneObject board;
    board.name = "checkerboard";
    board.pose = poseAt(seconds);
    board.outline = scene::project(scene::corners(board.pose, kInnerCorners), lens.camera, 1);
    board.center = lens.camera.project(cv::Point3d(board.pose.translation()));
    board.visible = true;
    return {0, scene::cameraPose(0.0), {board}};
  }

  void paint(double seconds, cv::Mat& bgr) const override
  {
    bgr.setTo(kBackground);
    scene::paintBoard(texture, poseAt(seconds), size, lens, bgr);
  }

  cv::Size2d size = scene::checkerBoard().size;
  scene::Texture texture = scene::cellTexture(scene::checkerCells());
};

struct RoadScene::Drive : Content
{
  explicit Drive(const SceneParams& params) : Content(params), still(params.still) {}

  scene::RoadPlace placeAt(double seconds) const { return scene::roadPlace(still ? 0.0 : seconds); }

  SceneTruth truth(double seconds) const override
  {
    const scene::RoadPlace place = placeAt(seconds);
    const cv::Affine3d camera = scene::mountedCamera(place.robot), world_in_camera = camera.inv();
    scene::Polygon3 ahead = scene::laneAhead(place.along);
    for (cv::Point3d& point : ahead)
      point = world_in_camera * point;
    SceneObject lane;
    lane.name = "lane";
    lane.pose = world_in_camera * place.lane;
    lane.outline = scene::clipToImage(scene::project(scene::clipToView(ahead, lens), lens.camera, 1), lens.camera);
    lane.center = lens.camera.project(cv::Point3d(lane.pose.translation()));
    return {0, camera, {lane}};
  }

  void paint(double seconds, cv::Mat& bgr) const override
  {
    bgr.setTo(scene::kGrass);
    const cv::Affine3d world_in_camera = scene::mountedCamera(placeAt(seconds).robot).inv();
    scene::paintBoard(texture, world_in_camera * board.pose, board.size, lens, bgr);
  }

  bool still;
  scene::Board board = scene::onFloor(0.0, 0.0, scene::roadSize());
  scene::Texture texture = scene::imageTexture(scene::roadImage());
};

Scene::Scene(std::unique_ptr<const Content> content) : content_(std::move(content))
{
}

Scene::Scene(const SceneParams& params, const cv::Mat& poster_bgr)
  : Scene(std::make_unique<const Room>(params, poster_bgr))
{
}

CalibrationScene::CalibrationScene(const SceneParams& params) : Scene(std::make_unique<const ShownBoard>(params))
{
}

RoadScene::RoadScene(const SceneParams& params) : Scene(std::make_unique<const Drive>(params))
{
}

Scene::~Scene() = default;

const CameraModel& Scene::camera() const
{
  return content_->lens.camera;
}

SceneTruth Scene::truth(std::int64_t frame) const
{
  SceneTruth truth = content_->truth(scene::sceneTime(frame, content_->rate));
  truth.frame = frame;
  return truth;
}

void Scene::render(std::int64_t frame, cv::Mat& bgr) const
{
  bgr.create(camera().height, camera().width, CV_8UC3);
  content_->paint(scene::sceneTime(frame, content_->rate), bgr);
  content_->noise.add(frame, bgr);
}

}  // namespace robot_vision
