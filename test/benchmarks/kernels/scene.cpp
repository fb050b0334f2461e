#include "robot_vision/scene/scene.hpp"

#include "contests.hpp"
#include "core/scene/scene_canvas.hpp"
#include "core/scene/scene_noise.hpp"
#include "core/scene/scene_renderer.hpp"
#include "support/plain_texture.hpp"

namespace bench
{
namespace
{

/// The room of the demo, a second of it with each frame.
struct RoomState
{
  explicit RoomState(const Setup& setup)
    : params(paramsOf(setup.frames.front().size())),
      scene(params),
      lens(robot_vision::scene::sceneCamera(params.width, params.height)),
      noise(params.noise, params.seed, 3 * params.width)
  {
  }

  static robot_vision::SceneParams paramsOf(const cv::Size& size)
  {
    robot_vision::SceneParams params;
    params.width = size.width;
    params.height = size.height;
    return params;
  }

  static std::int64_t frame(std::size_t i) { return 30 * static_cast<std::int64_t>(i); }

  void byOpenCv(std::size_t i)
  {
    const double seconds = robot_vision::scene::sceneTime(frame(i), params.rate);
    results.theirs.create(params.height, params.width, CV_8UC3);
    robot_vision::scene::ColorCanvas canvas(lens, results.theirs, drawPlainly);
    room.draw(seconds, robot_vision::scene::cameraPose(seconds).inv(), canvas);
    noise.add(frame(i), results.theirs);
  }

  void byUs(std::size_t i) { scene.render(frame(i), results.ours); }
  bool same() const { return results.same(); }

  robot_vision::SceneParams params;
  robot_vision::Scene scene;
  robot_vision::scene::SceneRenderer room;
  robot_vision::scene::Lens lens;
  robot_vision::scene::PixelNoise noise;
  Results results;
};

}  // namespace

std::vector<Work> sceneWorks()
{
  return {{"a frame of the synthetic room", "textures by a plain loop", 2.0, contestOf<RoomState>()}};
}

}  // namespace bench
