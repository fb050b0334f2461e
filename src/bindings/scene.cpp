#include "robot_vision/scene/scene.hpp"

#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "arrays.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/scene/depth_noise.hpp"
#include "robot_vision/scene/floor_scene.hpp"
#include "robot_vision/scene/tabletop_scene.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace scene_bindings
{

void bindScenes(py::module& m)
{
  bindParams<SceneParams>(m, "SceneParams", "What the frames of a Scene are like.");

  py::class_<SceneObject>(m, "SceneObject", "One thing in the scene, as one frame shows it.")
      .def_readonly("name", &SceneObject::name)
      .def_property_readonly("pose", attribute(&SceneObject::pose), "4x4, object in the camera's optical frame, m")
      .def_property_readonly("outline", attribute(&SceneObject::outline), "(n, 2) array, px")
      .def_property_readonly("center", attribute(&SceneObject::center), "(x, y), px")
      .def_readonly("visible", &SceneObject::visible);

  py::class_<SceneTruth>(m, "SceneTruth", "Where everything in the scene is in one frame.")
      .def_readonly("frame", &SceneTruth::frame)
      .def_property_readonly("camera", attribute(&SceneTruth::camera), "4x4, camera in the world, m")
      .def_readonly("objects", &SceneTruth::objects);

  py::class_<Scene>(
      m, "Scene",
      "A synthetic room with exact ground truth, the same for the same frame number. Threads may share one.")
      .def(py::init([](const SceneParams& params, const std::optional<py::array>& poster)
                    { return std::make_unique<Scene>(params, poster ? ImageArray(*poster).view : cv::Mat()); }),
           "params"_a = SceneParams(), "poster"_a = py::none(), "poster: (height, width, 3) BGR image for the wall.")
      .def_property_readonly(
          "camera", [](const Scene& scene) -> const CameraModel& { return scene.camera(); }, "the color camera")
      .def(
          "view_camera",
          [](const Scene& scene, const std::string& view) -> const CameraModel&
          { return scene.camera(sceneView(view)); },
          "view"_a, py::return_value_policy::reference_internal,
          "The camera of a view: color, right (of the stereo pair, whose left one is the color camera) or depth.\n\n"
          "Raises ValueError for any other one.")
      .def(
          "view_pose",
          [](const Scene& scene, const std::string& view) { return toPython(scene.viewPose(sceneView(view))); },
          "view"_a, "4x4 pose of a view's optical frame in that of the color camera, m.")
      .def("truth", &Scene::truth, "frame"_a)
      .def(
          "render",
          [](const Scene& scene, std::int64_t frame, const std::string& view)
          { return imageFrom([&](cv::Mat& bgr) { scene.render(frame, bgr, sceneView(view)); }); },
          "frame"_a, "view"_a = "color", "The image of a frame: (height, width, 3) uint8, BGR. view: color or right.")
      .def(
          "render_depth",
          [](const Scene& scene, std::int64_t frame, const std::string& view)
          { return imageFrom([&](cv::Mat& depth) { scene.renderDepth(frame, depth, sceneView(view)); }); },
          "frame"_a, "view"_a = "depth",
          "The exact depth in a frame: (height, width) float32, z in m of what the ray of each pixel meets first, NaN "
          "where it meets nothing.");

  py::class_<CalibrationScene, Scene>(m, "CalibrationScene",
                                      "A checkerboard shown to the Scene's camera, each half second in another pose.")
      .def(py::init<const SceneParams&>(), "params"_a = SceneParams());

  py::class_<RoadScene, Scene>(m, "RoadScene", "A robot drives in the lane of a road, around an oval to the left.")
      .def(py::init<const SceneParams&>(), "params"_a = SceneParams());

  py::class_<TabletopScene, Scene>(m, "TabletopScene", "Meshes on a table, which the camera moves slowly around.")
      .def(py::init(
               [](const SceneParams& params, const std::optional<std::vector<std::pair<std::string, Mesh>>>& meshes)
               {
                 std::vector<TabletopMesh> standing;
                 if (!meshes) standing = sampleTabletop();
                 for (const auto& mesh : meshes.value_or(std::vector<std::pair<std::string, Mesh>>()))
                   standing.push_back({mesh.first, mesh.second});
                 return withoutGil([&] { return std::make_unique<TabletopScene>(params, standing); });
               }),
           "params"_a = SceneParams(), "meshes"_a = py::none(),
           "meshes: list of (name, Mesh), with z up; None: the sample meshes.\n\nRaises ValueError for a mesh "
           "that is too tall, if there is no room for all, and for names that are not unique.");
}

py::array renderFloor(const FloorScene& scene, const Matrix& camera)
{
  const cv::Affine3d pose = toPose(camera, "4x4 pose of the camera");
  return imageFrom([&](cv::Mat& bgr) { scene.render(pose, bgr); });
}

void bindFloor(py::module& m)
{
  using Bgr = std::array<double, 3>;
  py::class_<FloorScene>(m, "FloorScene",
                         "A floor with an image on it, as a camera above it sees it. Threads may share one.")
      .def(py::init(
               [](const py::array& floor, std::pair<double, double> size, const CameraModel& camera, const Bgr& around)
               {
                 return std::make_unique<FloorScene>(ImageArray(floor).view, cv::Size2d(size.first, size.second),
                                                     camera, cv::Scalar(around[0], around[1], around[2]));
               }),
           "floor"_a, "size"_a, "camera"_a, "around"_a = Bgr{150.0, 150.0, 150.0},
           "floor: (height, width, 3) BGR, its top forward (+x), its left side left (+y), the origin in its middle; "
           "size: (width, height), m; around: the floor's colour elsewhere.\n\n"
           "Raises ValueError if one of them is none.")
      .def("render", &renderFloor, "camera"_a,
           "(height, width, 3) uint8, BGR. camera: 4x4, its optical frame in the world, m; it must not see the "
           "horizon.");
}

py::array applyNoise(const DepthNoise& noise, std::int64_t frame, const py::array& exact,
                     const std::optional<py::array>& brightness)
{
  if (exact.dtype().kind() != 'f')
    throw py::type_error("expected depth as an array of float32, got " + std::string(py::str(exact.dtype())));
  const FloatArray values(exact);
  const cv::Mat depth = floatView(values, "(height, width) array of depth");
  const std::optional<ImageArray> light = brightness ? std::optional<ImageArray>(*brightness) : std::nullopt;
  return imageFrom([&](cv::Mat& noisy) { noise.apply(frame, depth, light ? light->view : cv::Mat(), noisy); });
}

void bindDepthNoise(py::module& m)
{
  py::class_<DepthNoise>(m, "DepthNoise", "Makes of exact depth what a sensor would measure. Threads may share one.")
      .def(py::init([](const std::string& sensor, const CameraModel& camera, std::uint64_t seed)
                    { return std::make_unique<DepthNoise>(depthSensor(sensor), camera, seed); }),
           "sensor"_a, "camera"_a, "seed"_a = 1,
           "sensor: none, kinect, stereo or tof; camera: that of the depth.\n\n"
           "Raises ValueError for any other sensor.")
      .def("apply", &applyNoise, "frame"_a, "exact"_a, "brightness"_a = py::none(),
           "(height, width) float32, z in m, NaN where the sensor has nothing. exact: the same without noise; "
           "brightness: (height, width) uint8, what the same pixels reflect, or None for 128 everywhere. The noise of "
           "a frame depends on the seed and its number only.\n\n"
           "Raises ValueError for an image that is not of the camera's size.");
}

void bindScene(py::module& m)
{
  bindScenes(m);
  bindFloor(m);
  bindDepthNoise(m);
}

const Bindings kBindings("scene", {"geometry", "meshes"}, bindScene);

}  // namespace scene_bindings
