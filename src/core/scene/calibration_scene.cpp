#include "calibration_poses.hpp"
#include "scene_content.hpp"
#include "scene_model.hpp"
#include "scene_textures.hpp"

namespace robot_vision
{

namespace
{

const double kPoseTime = 0.5;                 // s, how long each pose of the checkerboard is shown
const cv::Scalar kBackground(128, 140, 146);  // gray, far from the checkerboard's black and white
const cv::Size2d kInnerCorners(7.0 * kSceneCheckerSquare, 5.0 * kSceneCheckerSquare);

}  // namespace

struct CalibrationScene::ShownBoard : Content
{
  using Content::Content;

  cv::Affine3d poseAt(double seconds) const
  {
    return scene::shownBoard(static_cast<int>(seconds / kPoseTime), size, cameras.color().camera);
  }

  SceneTruth truth(double seconds) const override
  {
    const CameraModel& camera = cameras.color().camera;
    SceneObject board;
    board.name = "checkerboard";
    board.pose = poseAt(seconds);
    board.outline = scene::project(scene::corners(board.pose, kInnerCorners), camera, 1);
    board.center = camera.project(cv::Point3d(board.pose.translation()));
    board.visible = true;
    return {0, scene::cameraPose(0.0), {board}};
  }

  void draw(double seconds, const cv::Vec3d& offset, scene::Canvas& canvas) const override
  {
    canvas.background(kBackground);
    canvas.board(texture, poseAt(seconds).translate(-offset), size);
  }

  cv::Size2d size = scene::checkerBoard().size;
  scene::Texture texture = scene::cellTexture(scene::checkerCells());
};

CalibrationScene::CalibrationScene(const SceneParams& params) : Scene(std::make_unique<const ShownBoard>(params))
{
}

}  // namespace robot_vision
