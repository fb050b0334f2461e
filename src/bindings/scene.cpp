#include "robot_vision/scene/scene.hpp"

#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "arrays.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/scene/floor_scene.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
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

  py::class_<Scene>(m, "Scene", "A synthetic room with exact ground truth, the same for the same frame number.")
      .def(py::init([](const SceneParams& params, const std::optional<py::array>& poster)
                    { return std::make_unique<Scene>(params, poster ? ImageArray(*poster).view : cv::Mat()); }),
           "params"_a = SceneParams(), "poster"_a = py::none(), "poster: (height, width, 3) BGR image for the wall.")
      .def_property_readonly("camera", &Scene::camera)
      .def("truth", &Scene::truth, "frame"_a)
      .def(
          "render",
          [](const Scene& scene, std::int64_t frame)
          { return imageFrom([&](cv::Mat& bgr) { scene.render(frame, bgr); }); },
          "frame"_a, "The image of a frame: (height, width, 3) uint8, BGR.");

  py::class_<CalibrationScene, Scene>(m, "CalibrationScene",
                                      "A checkerboard shown to the Scene's camera, each half second in another pose.")
      .def(py::init<const SceneParams&>(), "params"_a = SceneParams());

  py::class_<RoadScene, Scene>(m, "RoadScene", "A robot drives in the lane of a road, around an oval to the left.")
      .def(py::init<const SceneParams&>(), "params"_a = SceneParams());
}

py::array renderFloor(const FloorScene& scene, const Matrix& camera)
{
  const cv::Affine3d pose = toPose(camera, "4x4 pose of the camera");
  return imageFrom([&](cv::Mat& bgr) { scene.render(pose, bgr); });
}

void bindFloor(py::module& m)
{
  using Bgr = std::array<double, 3>;
  py::class_<FloorScene>(m, "FloorScene", "A floor with an image on it, as a camera above it sees it.")
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

void bindScene(py::module& m)
{
  bindScenes(m);
  bindFloor(m);
}

const Bindings kBindings("scene", {"geometry"}, bindScene);

}  // namespace
