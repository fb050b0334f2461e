#include "scene_source.hpp"

#include <filesystem>

#include "picture_source.hpp"
#include "robot_vision/range.hpp"

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

/// The photograph of a face that python3-skimage brings along.
constexpr const char* kPortrait = "/usr/lib/python3/dist-packages/skimage/data/astronaut.png";

/// An empty picture: the scene has a pattern of its own.
cv::Mat readPoster(const std::string& poster)
{
  if (poster.empty() || (poster == "auto" && !std::filesystem::exists(kPortrait))) return {};
  return readPicture(poster == "auto" ? kPortrait : poster);
}

}  // namespace

SceneSource::SceneSource(const CaptureParams& params)
  : rate_(wantedRate(params)), scene_(sceneParams(params), readPoster(params.poster))
{
}

ReadResult SceneSource::read(Frame& frame)
{
  scene_.render(next_, frame.image);
  frame.encoding = "bgr8";
  frame.truth = std::make_shared<const SceneTruth>(scene_.truth(next_));
  frame.sequence = next_++;
  frame.monotonic_ns = 0;
  return ReadResult::kFrame;
}

std::string SceneSource::description() const
{
  const CameraModel& camera = scene_.camera();
  return "synthetic scene " + std::to_string(camera.width) + "x" + std::to_string(camera.height) + " at " +
         toText(rate_) + " Hz";
}

}  // namespace robot_vision
