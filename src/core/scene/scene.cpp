#include "robot_vision/scene/scene.hpp"

#include <stdexcept>
#include <utility>

#include "robot_vision/common/range.hpp"
#include "robot_vision/common/shared_instance.hpp"
#include "scene_content.hpp"
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

SceneView sceneView(const std::string& name)
{
  checkField("view", name, OneOf{"color, right or depth", "'"});
  if (name == "color") return SceneView::kColor;
  return name == "right" ? SceneView::kRight : SceneView::kDepth;
}

namespace
{

/// The renderer of a poster. Scenes without a poster share one, because building it takes a while.
std::shared_ptr<const scene::SceneRenderer> rendererFor(const cv::Mat& poster)
{
  if (!poster.empty() && poster.type() != CV_8UC3) throw std::invalid_argument("poster must be an 8-bit BGR image");
  if (!poster.empty()) return std::make_shared<const scene::SceneRenderer>(poster);
  return sharedInstance<const scene::SceneRenderer>();
}

}  // namespace

Scene::Content::Content(const SceneParams& params)
  : rate((validate(params), params.rate)),
    cameras(params.width, params.height),
    noise(params.noise, params.seed, 3 * params.width),
    right_noise(params.noise, ~params.seed, 3 * params.width)
{
}

struct Scene::Room : Content
{
  Room(const SceneParams& params, const cv::Mat& poster)
    : Content(params), still(params.still), renderer(rendererFor(poster))
  {
  }

  cv::Affine3d cameraAt(double seconds) const { return scene::cameraPose(still ? 0.0 : seconds); }

  SceneTruth truth(double seconds) const override
  {
    return scene::truthAt(seconds, cameraAt(seconds), renderer->posterAspect(), cameras.color());
  }

  void draw(double seconds, const cv::Vec3d& offset, scene::Canvas& canvas) const override
  {
    renderer->draw(seconds, cameraAt(seconds).inv().translate(-offset), canvas);
  }

  bool still;
  std::shared_ptr<const scene::SceneRenderer> renderer;
};

Scene::Scene(std::unique_ptr<const Content> content) : content_(std::move(content)), rate_(content_->rate)
{
}

Scene::Scene(const SceneParams& params, const cv::Mat& poster_bgr)
  : Scene(std::make_unique<const Room>(params, poster_bgr))
{
}

Scene::~Scene() = default;

void Scene::setRate(double rate)
{
  SceneParams params;
  params.rate = rate;
  validate(params);
  rate_ = rate;
}

const CameraModel& Scene::camera(SceneView view) const
{
  return content_->cameras.model(view);
}

cv::Affine3d Scene::viewPose(SceneView view) const
{
  return cv::Affine3d(cv::Matx33d::eye(), scene::viewOffset(view));
}

SceneTruth Scene::truth(std::int64_t frame) const
{
  SceneTruth truth = content_->truth(scene::sceneTime(frame, rate_));
  truth.frame = frame;
  return truth;
}

void Scene::render(std::int64_t frame, cv::Mat& bgr, SceneView view) const
{
  require(view != SceneView::kDepth, "view", "'depth'", "color or right for an image in color");
  const scene::Lens& lens = content_->cameras.lens(view);
  bgr.create(lens.camera.height, lens.camera.width, CV_8UC3);
  scene::ColorCanvas canvas(lens, bgr);
  content_->draw(scene::sceneTime(frame, rate_), scene::viewOffset(view), canvas);
  (view == SceneView::kRight ? content_->right_noise : content_->noise).add(frame, bgr);
}

void Scene::renderDepth(std::int64_t frame, cv::Mat& depth, SceneView view) const
{
  const scene::Lens& lens = content_->cameras.lens(view);
  depth.create(lens.camera.height, lens.camera.width, CV_32FC1);
  scene::DepthCanvas canvas(lens, depth);
  content_->draw(scene::sceneTime(frame, rate_), scene::viewOffset(view), canvas);
  canvas.finish();
}

}  // namespace robot_vision
