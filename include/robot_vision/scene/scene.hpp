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

// The dimensions of what the scene shows, in metres.
constexpr double kSceneTagSide = 0.24;        // outer edge of a tag's black border
constexpr double kSceneQrSide = 0.504;        // 21 modules, without the quiet zone
constexpr double kSceneCheckerSquare = 0.05;  // one square of the checkerboard (8 x 6 inner corners)
constexpr double kSceneBallRadius = 0.1;
constexpr double kSceneLineWidth = 0.06;
constexpr double kSceneRoadRadius = 2.0;       // of the curves of the RoadScene, in the middle of the lane
constexpr double kSceneLaneWidth = 0.4;        // between the middles of its lines
constexpr double kSceneRoadLine = 0.02;        // width of a line
constexpr double kSceneCameraHeight = 0.25;    // of the robot's camera above the road
constexpr double kSceneCameraPitch = 0.6;      // rad, by which it looks down
constexpr double kSceneStereoBaseline = 0.1;   // from the color camera to the right camera of the stereo pair
constexpr double kSceneDepthBaseline = 0.025;  // from the depth camera to the color camera, as in a Kinect
constexpr double kScenePeriod = 20.0;          // s after which every motion repeats

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

/// One object of the scene as one frame shows it.
///
/// - Planar objects (tag_0, tag_1, qr_code, checkerboard, poster): x points right and y up for a viewer in front, z out
///   of the face towards the viewer; the origin is in the middle. The outline has four corners, counter-clockwise for
///   that viewer and starting at the bottom left, which is AprilTag's order. It follows the outer edge of a tag's black
///   border, the modules of the QR code without the quiet zone, the outermost inner corners of the checkerboard, and
///   the image on the poster without its frame.
/// - box: x points right, y up, z out of the face towards the room; the origin is in its middle. The outline is its
///   convex silhouette.
/// - ball: it has the axes of the world and the origin in its middle. The outline has 64 points of the exact
///   silhouette; their centroid is not `center`, because a sphere off the optical axis is seen as an ellipse.
/// - lane, of the RoadScene: x points along it, y to its left, z up; the origin is on its middle, beside the robot. The
///   outline is the part ahead inside the image, between the middles of its lines.
/// - line: x points right, y away from the robot, z up; the origin is on its middle line. The outline is the part
///   inside the image.
/// - meshes, of the TabletopScene: see there.
struct SceneObject
{
  std::string name;                  // ball, tag_0, tag_1, qr_code, checkerboard, line, box, poster, lane
  cv::Affine3d pose;                 // object in the camera's optical frame, m
  std::vector<cv::Point2d> outline;  // px in the (distorted) image, sub-pixel
  cv::Point2d center;                // px, projection of the object's origin
  bool visible = false;              // faces the camera, is completely in the image, and nothing nearer overlaps it
};

struct SceneTruth
{
  std::int64_t frame = 0;
  cv::Affine3d camera;  // camera's optical frame in the world: x forward, y left, z up, origin on the floor, m
  std::vector<SceneObject> objects;
};

/// The cameras that see the scene. They are fixed to each other and look in the same direction.
///
/// - The color camera is also the left one of the stereo pair.
/// - The right camera of the stereo pair is of the same model, and kSceneStereoBaseline to the right of it.
/// - The depth camera is kSceneDepthBaseline to the left of the color camera, has a lens of its own, and sees a little
///   more than a color image of 4:3. Its images always are 4:3, as wide as the color images and at most 640x480: so are
///   those of a Kinect, whatever size its color images have.
enum class SceneView
{
  kColor,
  kRight,
  kDepth,
};

/// The view of a name: color, right or depth. Throws std::invalid_argument for any other name.
SceneView sceneView(const std::string& name);

/// A room drawn from exact geometry and seen by moving cameras. An image and its ground truth depend on the parameters,
/// the poster and the frame number only. All methods but setRate() are const and use no scratch memory, so threads may
/// share one scene.
class Scene
{
public:
  /// Builds the textures and ray tables for one image size. `poster_bgr` (CV_8UC3, any size, copied) hangs on the wall,
  /// its longer side 1.1 m long; if it is empty, a generated pattern hangs there. Throws std::invalid_argument as
  /// validate does, and for a poster of another type.
  explicit Scene(const SceneParams& params, const cv::Mat& poster_bgr = cv::Mat());
  ~Scene();

  /// Shows the motion at another number of frames per second than that of the parameters, as a scene of that rate does.
  /// Throws std::invalid_argument as validate does.
  void setRate(double rate);

  const CameraModel& camera(SceneView view = SceneView::kColor) const;

  /// The pose of a view's optical frame in the color camera's optical frame, m.
  cv::Affine3d viewPose(SceneView view) const;

  /// Poses and pixel positions of all objects in a frame of the color camera, always in the same order.
  SceneTruth truth(std::int64_t frame) const;

  /// Draws a frame of the color camera or the right one as CV_8UC3 BGR. An image of the right size and type is written
  /// in place, also when its rows are padded or its memory belongs to somebody else. Throws std::invalid_argument for
  /// the depth camera, which sees no colors.
  void render(std::int64_t frame, cv::Mat& bgr, SceneView view = SceneView::kColor) const;

  /// The exact depth in a frame as CV_32FC1: z (m) in the view's optical frame of what the ray through the middle of
  /// each pixel meets first, NaN where it meets nothing. It is without noise, which a DepthNoise adds. The image is
  /// written in place as by render().
  void renderDepth(std::int64_t frame, cv::Mat& depth, SceneView view = SceneView::kDepth) const;

protected:
  struct Content;
  explicit Scene(std::unique_ptr<const Content> content);

private:
  struct Room;
  std::unique_ptr<const Content> content_;
  double rate_;  // Hz
};

/// A checkerboard is shown to the Scene's camera as one does to calibrate it: every half second in another pose, all
/// over the image, near and far, tilted to all sides and always completely in view. It is the room's checkerboard:
/// squares of kSceneCheckerSquare, 8 x 6 inner corners. It is the only object of the truth. The camera stays where the
/// room's camera is in frame 0.
class CalibrationScene : public Scene
{
public:
  /// The parameter `still` has no effect here. Throws std::invalid_argument as validate(SceneParams) does.
  explicit CalibrationScene(const SceneParams& params);

private:
  struct ShownBoard;
};

/// A robot drives in the lane of a road, once around an oval of two straights and two half circles to the left, and
/// sways a little. The left line is yellow and dashed, the right one white. The camera is kSceneCameraHeight above the
/// robot's origin and looks down by kSceneCameraPitch. The lane is the only object of the truth.
class RoadScene : public Scene
{
public:
  /// The parameter `still` has the robot stay where it is in frame 0. Throws std::invalid_argument as
  /// validate(SceneParams) does.
  explicit RoadScene(const SceneParams& params);

private:
  struct Drive;
};

}  // namespace robot_vision
