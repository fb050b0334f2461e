#include "robot_vision/scene/calibration_scene.hpp"

#include "calibration_poses.hpp"
#include "scene_model.hpp"
#include "scene_noise.hpp"
#include "scene_painter.hpp"
#include "scene_textures.hpp"
#include "scene_view.hpp"

namespace robot_vision
{
namespace
{

const double kPoseTime = 0.5;                 // s, how long each pose is shown
const cv::Scalar kBackground(128, 140, 146);  // gray, far from the board's black and white
const cv::Size2d kInnerCorners(7.0 * kSceneCheckerSquare, 5.0 * kSceneCheckerSquare);

const SceneParams& validated(const SceneParams& params)
{
  validate(params);
  return params;
}

}  // namespace

struct CalibrationScene::Impl
{
  explicit Impl(const SceneParams& params)
    : rate(validated(params).rate),
      board(scene::checkerBoard()),
      texture(scene::cellTexture(scene::checkerCells())),
      lens(scene::sceneCamera(params.width, params.height)),
      noise(params.noise, params.seed, 3 * params.width)
  {
  }

  cv::Affine3d poseAt(std::int64_t frame) const
  {
    const int view = static_cast<int>(scene::sceneTime(frame, rate) / kPoseTime);
    return scene::shownBoard(view, board.size, lens.camera);
  }

  double rate;
  scene::Board board;
  scene::Texture texture;
  scene::Lens lens;
  scene::PixelNoise noise;
};

CalibrationScene::CalibrationScene(const SceneParams& params) : impl_(std::make_unique<const Impl>(params))
{
}

CalibrationScene::~CalibrationScene() = default;
CalibrationScene::CalibrationScene(CalibrationScene&&) noexcept = default;
CalibrationScene& CalibrationScene::operator=(CalibrationScene&&) noexcept = default;

const CameraModel& CalibrationScene::camera() const
{
  return impl_->lens.camera;
}

SceneTruth CalibrationScene::truth(std::int64_t frame) const
{
  SceneObject board;
  board.name = "checkerboard";
  board.pose = impl_->poseAt(frame);
  board.outline = scene::project(scene::corners(board.pose, kInnerCorners), camera(), 1);
  board.center = camera().project(cv::Point3d(board.pose.translation()));
  board.visible = true;
  SceneTruth truth;
  truth.frame = frame;
  truth.camera = scene::cameraPose(0.0);
  truth.objects = {board};
  return truth;
}

void CalibrationScene::render(std::int64_t frame, cv::Mat& bgr) const
{
  bgr.create(camera().height, camera().width, CV_8UC3);
  bgr.setTo(kBackground);
  scene::paintBoard(impl_->texture, impl_->poseAt(frame), impl_->board.size, impl_->lens, bgr);
  impl_->noise.add(frame, bgr);
}

}  // namespace robot_vision
