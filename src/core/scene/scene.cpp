#include "robot_vision/scene/scene.hpp"

#include <memory>
#include <stdexcept>

#include "robot_vision/common/range.hpp"
#include "robot_vision/common/shared_instance.hpp"
#include "scene_model.hpp"
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

const SceneParams& validated(const SceneParams& params)
{
  validate(params);
  return params;
}

/// The renderer of a poster. Scenes without a poster share one, because building it takes a while.
std::shared_ptr<const scene::SceneRenderer> rendererFor(const cv::Mat& poster)
{
  if (!poster.empty() && poster.type() != CV_8UC3) throw std::invalid_argument("poster must be an 8-bit BGR image");
  if (!poster.empty()) return std::make_shared<const scene::SceneRenderer>(poster);
  return sharedInstance<const scene::SceneRenderer>();
}

}  // namespace

struct Scene::Impl
{
  Impl(const SceneParams& params, const cv::Mat& poster)
    : rate(validated(params).rate),
      still(params.still),
      renderer(rendererFor(poster)),
      lens(scene::sceneCamera(params.width, params.height)),
      noise(params.noise, params.seed, 3 * params.width)
  {
  }

  double timeOf(std::int64_t frame) const { return scene::sceneTime(frame, rate); }

  cv::Affine3d cameraAt(std::int64_t frame) const { return scene::cameraPose(still ? 0.0 : timeOf(frame)); }

  double rate;
  bool still;
  std::shared_ptr<const scene::SceneRenderer> renderer;
  scene::Lens lens;
  scene::PixelNoise noise;
};

Scene::Scene(const SceneParams& params, const cv::Mat& poster_bgr)
  : impl_(std::make_unique<const Impl>(params, poster_bgr))
{
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const CameraModel& Scene::camera() const
{
  return impl_->lens.camera;
}

SceneTruth Scene::truth(std::int64_t frame) const
{
  SceneTruth truth =
      scene::truthAt(impl_->timeOf(frame), impl_->cameraAt(frame), impl_->renderer->posterAspect(), impl_->lens);
  truth.frame = frame;
  return truth;
}

void Scene::render(std::int64_t frame, cv::Mat& bgr) const
{
  bgr.create(impl_->lens.camera.height, impl_->lens.camera.width, CV_8UC3);
  impl_->renderer->paint(impl_->timeOf(frame), impl_->cameraAt(frame), impl_->lens, bgr);
  impl_->noise.add(frame, bgr);
}

}  // namespace robot_vision
