#include "robot_vision/scene/floor_scene.hpp"

#include <cmath>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "scene_canvas.hpp"

namespace robot_vision
{
namespace
{

const cv::Size2d& validated(const cv::Size2d& size)
{
  for (const double length : {size.width, size.height})
    require(length > 0.0 && std::isfinite(length), "size", length, "positive (m)");
  return size;
}

}  // namespace

struct FloorScene::Impl
{
  Impl(const cv::Mat& image, const cv::Size2d& size, const CameraModel& camera, const cv::Scalar& color)
    : texture(scene::imageTexture((checkPixels(image, "bgr8"), image.clone()))),
      board(scene::onFloor(0.0, 0.0, validated(size))),
      lens((validate(camera), camera)),
      around(color)
  {
  }

  scene::Texture texture;
  scene::Board board;
  scene::Lens lens;
  cv::Scalar around;
};

FloorScene::FloorScene(const cv::Mat& floor_bgr, const cv::Size2d& size, const CameraModel& camera,
                       const cv::Scalar& around)
  : impl_(std::make_unique<const Impl>(floor_bgr, size, camera, around))
{
}

FloorScene::~FloorScene() = default;

void FloorScene::render(const cv::Affine3d& camera_in_world, cv::Mat& bgr) const
{
  bgr.create(impl_->lens.camera.height, impl_->lens.camera.width, CV_8UC3);
  scene::ColorCanvas canvas(impl_->lens, bgr);
  canvas.background(impl_->around);
  canvas.board(impl_->texture, camera_in_world.inv() * impl_->board.pose, impl_->board.size);
}

}  // namespace robot_vision
