#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

// What the scene is built from, in metres.
constexpr double kSceneTagSide = 0.24;        // outer edge of a tag's black border
constexpr double kSceneQrSide = 0.504;        // 21 modules, without the quiet zone
constexpr double kSceneCheckerSquare = 0.05;  // one square of the checkerboard (8 x 6 inner corners)
constexpr double kSceneBallRadius = 0.1;
constexpr double kSceneLineWidth = 0.06;
constexpr double kScenePeriod = 20.0;  // s after which every motion repeats

struct SceneParams
{
  int width = 640;
  int height = 480;
  double rate = 30.0;
  std::uint64_t seed = 1;
  double noise = 2.0;
  bool still = false;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("width", &SceneParams::width, Range{64, 4096}, "px", "of the image");
    visit("height", &SceneParams::height, Range{64, 4096}, "px",
          "of the image, between a third and three times the width");
    visit("rate", &SceneParams::rate, Above{0, 1000}, "Hz", "frames per second of the motion");
    visit("seed", &SceneParams::seed, Anything{}, "", "of the noise; everything else is the same for all seeds");
    visit("noise", &SceneParams::noise, Range{0, 30}, "gray levels",
          "standard deviation of the noise of each pixel; 0: none");
    visit("still", &SceneParams::still, Anything{}, "", "the camera stays where it is in frame 0");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and its range.
void validate(const SceneParams& params);

/// One thing in the scene, as one frame shows it.
///
/// Planar objects (tag_0, tag_1, qr_code, checkerboard, poster) have x right and y up as seen by a viewer in front,
/// z out of the face towards the viewer, the origin in the middle. Their outline has four corners, counter-clockwise
/// for that viewer from the bottom left one, which is AprilTag's order: of a tag the outer edge of the black border, of
/// the QR code its modules without the quiet zone, of the checkerboard the outermost inner corners, of the poster its
/// picture.
/// box: x right, y up, z out of the face towards the room, origin in its middle; outline: its convex silhouette.
/// ball: axes of the world, origin in its middle; outline: 64 points of the exact silhouette, whose centroid is not
/// `center` (a sphere off the optical axis is seen as an ellipse).
/// line: x right, y away from the robot, z up, origin on its middle line; outline: the part inside the picture.
struct SceneObject
{
  std::string name;                  // ball, tag_0, tag_1, qr_code, checkerboard, line, box, poster
  cv::Affine3d pose;                 // object in the camera's optical frame, m
  std::vector<cv::Point2d> outline;  // px in the (distorted) picture, sub-pixel
  cv::Point2d center;                // px, projection of the object's origin
  bool visible = false;              // outline inside the picture, facing the camera, no nearer object overlaps it
};

struct SceneTruth
{
  std::int64_t frame = 0;
  cv::Affine3d camera;  // camera's optical frame in the world: x forward, y left, z up, origin on the floor, m
  std::vector<SceneObject> objects;
};

/// A room drawn from exact geometry and seen by a moving camera. A picture and its truth depend on the parameters, the
/// poster and the frame number only. Const and without scratch memory: threads may share one scene.
class Scene
{
public:
  /// Builds the textures and ray tables for one picture size. `poster_bgr` (CV_8UC3, any size, copied) hangs on the
  /// wall, its longer side 1.1 m; without it a generated pattern does. Throws std::invalid_argument as validate does.
  explicit Scene(const SceneParams& params, const cv::Mat& poster_bgr = cv::Mat());
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  const CameraModel& camera() const;

  /// Poses and pixel positions of everything in a frame; objects come in the same order every time.
  SceneTruth truth(std::int64_t frame) const;

  /// Draws a frame as CV_8UC3 BGR. Memory of the right size and type is reused, foreign and padded rows included.
  void render(std::int64_t frame, cv::Mat& bgr) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
