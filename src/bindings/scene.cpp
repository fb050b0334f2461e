#include "robot_vision/scene.hpp"

#include <pybind11/stl.h>

#include <array>
#include <optional>

#include "arrays.hpp"
#include "robot_vision/floor_scene.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
{

CameraModel makeCamera(int width, int height, const py::array_t<double, py::array::c_style | py::array::forcecast>& K,
                       const std::vector<double>& D)
{
  if (K.size() != 9) throw py::value_error("K has " + std::to_string(K.size()) + " numbers, must have 9");
  CameraModel camera{width, height, cv::Matx33d(K.data()), D};
  validate(camera);
  return camera;
}

void bindCamera(py::module& m)
{
  py::class_<CameraModel>(m, "CameraModel", "Pinhole camera with plumb_bob or rational_polynomial distortion.")
      .def(py::init(&makeCamera), "width"_a, "height"_a, "K"_a, "D"_a = std::vector<double>(),
           "Size (px), K (3x3, px) and D (0, 4, 5 or 8 numbers), as in sensor_msgs/CameraInfo.\n\n"
           "Raises ValueError for numbers that no camera has.")
      .def_readonly("width", &CameraModel::width, "px")
      .def_readonly("height", &CameraModel::height, "px")
      .def_property_readonly(
          "K",
          [](const CameraModel& c) {
            return py::array_t<double>({3, 3}, c.K.val);
          },
          "3x3, px")
      .def_readonly("D", &CameraModel::D, "k1, k2, p1, p2, k3, k4, k5, k6: the first 0, 4, 5 or 8");
}

void bindRoom(py::module& m)
{
  py::class_<SceneParams>(
      m, "SceneParams",
      "Size (px), rate (Hz), seed and noise (grey levels) of the scene; still: its camera does not move.")
      .def(py::init<>())
      .def_readwrite("width", &SceneParams::width)
      .def_readwrite("height", &SceneParams::height)
      .def_readwrite("rate", &SceneParams::rate)
      .def_readwrite("seed", &SceneParams::seed)
      .def_readwrite("noise", &SceneParams::noise)
      .def_readwrite("still", &SceneParams::still);

  py::class_<SceneObject>(m, "SceneObject", "One thing in the scene, as one frame shows it.")
      .def_readonly("name", &SceneObject::name)
      .def_property_readonly(
          "pose", [](const SceneObject& o) { return toNumpy(o.pose.matrix); },
          "4x4, object in the camera's optical frame, m")
      .def_property_readonly(
          "outline", [](const SceneObject& o) { return toNumpy(o.outline); }, "(n, 2) array, px")
      .def_property_readonly(
          "center", [](const SceneObject& o) { return toPair(o.center); }, "(x, y), px")
      .def_readonly("visible", &SceneObject::visible);

  py::class_<SceneTruth>(m, "SceneTruth", "Where everything in the scene is in one frame.")
      .def_readonly("frame", &SceneTruth::frame)
      .def_property_readonly(
          "camera", [](const SceneTruth& t) { return toNumpy(t.camera.matrix); }, "4x4, camera in the world, m")
      .def_readonly("objects", &SceneTruth::objects);

  py::class_<Scene>(m, "Scene", "A synthetic room with exact ground truth, the same for the same frame number.")
      .def(py::init([](const SceneParams& params, const std::optional<py::array>& poster)
                    { return Scene(params, poster ? Picture(*poster).view : cv::Mat()); }),
           "params"_a = SceneParams(), "poster"_a = py::none(), "poster: (height, width, 3) BGR picture for the wall.")
      .def_property_readonly("camera", &Scene::camera)
      .def("truth", &Scene::truth, "frame"_a)
      .def(
          "render",
          [](const Scene& scene, std::int64_t frame)
          {
            cv::Mat bgr;
            {
              const py::gil_scoped_release unlocked;
              scene.render(frame, bgr);
            }
            return toNumpy(bgr);
          },
          "frame"_a, "The picture of a frame: (height, width, 3) uint8, BGR.");
}

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array renderFloor(const FloorScene& scene, const Matrix& camera)
{
  if (camera.ndim() != 2 || camera.shape(0) != 4 || camera.shape(1) != 4)
    throw py::value_error("expected a 4x4 pose of the camera");
  const cv::Affine3d pose(cv::Matx44d(camera.data()));
  cv::Mat bgr;
  {
    const py::gil_scoped_release unlocked;
    scene.render(pose, bgr);
  }
  return toNumpy(bgr);
}

void bindFloor(py::module& m)
{
  using Bgr = std::array<double, 3>;
  py::class_<FloorScene>(m, "FloorScene", "A floor with a picture on it, as a camera above it sees it.")
      .def(py::init(
               [](const py::array& floor, std::pair<double, double> size, const CameraModel& camera, const Bgr& around)
               {
                 return FloorScene(Picture(floor).view, cv::Size2d(size.first, size.second), camera,
                                   cv::Scalar(around[0], around[1], around[2]));
               }),
           "floor"_a, "size"_a, "camera"_a, "around"_a = Bgr{150.0, 150.0, 150.0},
           "floor: (height, width, 3) BGR, its top forward (+x), its left side left (+y), the origin in its middle; "
           "size: (width, height), m; around: the floor's colour elsewhere.\n\n"
           "Raises ValueError if one of them is none.")
      .def("render", &renderFloor, "camera"_a,
           "(height, width, 3) uint8, BGR. camera: 4x4, its optical frame in the world, m; it must not see the "
           "horizon.");
}

}  // namespace

/// Cameras, and what the synthetic ones see.
void bindScene(py::module& m)
{
  bindCamera(m);
  bindRoom(m);
  bindFloor(m);
}
