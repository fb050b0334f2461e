#include "scene_source.hpp"

#include <cmath>
#include <filesystem>

#include "image_files_source.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/scene/scene.hpp"
#include "robot_vision/scene/tabletop_scene.hpp"
#include "scene_meshes.hpp"
#include "scene_second_view.hpp"

namespace robot_vision
{
namespace
{

SceneParams sceneParams(const CaptureParams& params)
{
  SceneParams scene;
  scene.width = params.image_width;
  scene.height = params.image_height;
  scene.rate = wantedRate(params);
  return scene;
}

/// The photograph of a face that the package python3-skimage contains.
constexpr const char* kPortrait = "/usr/lib/python3/dist-packages/skimage/data/astronaut.png";

/// Reads the poster. The result is empty if the scene is to use its own pattern.
cv::Mat readPoster(const std::string& poster)
{
  if (poster.empty() || poster == "pattern" || (poster == "auto" && !std::filesystem::exists(kPortrait))) return {};
  try
  {
    return readUpright(poster == "auto" ? kPortrait : poster);
  }
  catch (const SourceError& e)
  {
    throw SourceError(std::string("poster: ") + e.what());
  }
}

/// The source of any scene, each frame with its ground truth, which is that of the first view.
template <class AnyScene>
class SceneSource : public FrameSource
{
public:
  /// `content` is the poster of a Scene, or the meshes of a TabletopScene; the others have none.
  template <class... Content>
  explicit SceneSource(const CaptureParams& params, const Content&... content)
    : name_(params.scene),
      rate_(wantedRate(params)),
      scene_(sceneParams(params), content...),
      second_(params.views == "one" ? nullptr : std::make_unique<SceneSecondView>(scene_, params))
  {
  }

  ReadResult read(Frame& frame) override
  {
    if (frame.wanted.first || !second_)
      scene_.render(next_, frame.image);
    else
      frame.image.release();
    if (second_ && frame.wanted.second) second_->render(next_, frame.image, frame.second);
    frame.encoding = "bgr8";
    frame.truth = std::make_shared<const SceneTruth>(scene_.truth(next_));
    frame.sequence = sequence_++;
    frame.monotonic_ns = 0;
    ++next_;
    return ReadResult::kFrame;
  }

  double rate() const override { return rate_; }

  bool setRate(double rate) override
  {
    scene_.setRate(rate);
    next_ = std::llround(static_cast<double>(next_) * rate / rate_);
    rate_ = rate;
    return true;
  }

  std::string description() const override
  {
    const auto size = [](const CameraModel& camera) { return sizeText(camera.width, camera.height); };
    const std::string second = second_ ? " and " + size(second_->camera().model) : "";
    return "synthetic scene (" + name_ + ") " + size(scene_.camera()) + second + " at " + toText(rate_) + " Hz";
  }

  std::string warning() const override { return remarks_; }

  void remark(const std::string& text) { remarks_ = text; }

  const CameraModel* cameraModel() const override { return &scene_.camera(); }

  const SecondCamera* secondCamera() const override { return second_ ? &second_->camera() : nullptr; }

private:
  std::string name_, remarks_;
  double rate_;
  AnyScene scene_;
  std::unique_ptr<SceneSecondView> second_;  // null with one view
  std::int64_t next_ = 0;                    // frame of the motion, which has another number at another rate
  std::int64_t sequence_ = 0;
};

std::unique_ptr<FrameSource> openTabletop(const CaptureParams& params)
{
  const SceneMeshes read = readSceneMeshes(params.meshes);
  auto source = std::make_unique<SceneSource<TabletopScene>>(params, read.meshes);
  source->remark(read.remarks);
  return source;
}

}  // namespace

std::unique_ptr<FrameSource> openScene(const CaptureParams& params)
{
  if (params.scene == "calibration") return std::make_unique<SceneSource<CalibrationScene>>(params);
  if (params.scene == "road") return std::make_unique<SceneSource<RoadScene>>(params);
  if (params.scene == "tabletop") return openTabletop(params);
  return std::make_unique<SceneSource<Scene>>(params, readPoster(params.poster));
}

}  // namespace robot_vision
