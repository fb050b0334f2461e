#include "robot_vision/scene/scene.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "robot_vision/scene/calibration_scene.hpp"
#include "robot_vision/scene/floor_scene.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
{

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

cv::Matx33d toK(const Matrix& K)
{
  if (K.size() != 9) throw py::value_error("K has " + std::to_string(K.size()) + " numbers, must have 9");
  return cv::Matx33d(K.data());
}

CameraModel makeCamera(std::int64_t width, std::int64_t height, const Matrix& K, const std::vector<double>& D,
                       const std::string& distortion_model)
{
  static constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();  // messages have more
  const auto side = [](std::int64_t given) { return static_cast<int>(std::clamp(given, -kMaxInt, kMaxInt)); };
  CameraModel camera{side(width), side(height), toK(K), D, distortion_model};
  validate(camera);
  return camera;
}

py::tuple project(const CameraModel& camera, const Matrix& points)
{
  if (points.ndim() != 2 || points.shape(1) != 3) throw py::value_error("expected an (n, 3) array of points");
  const py::ssize_t count = points.shape(0);
  py::array_t<double> pixels({count, py::ssize_t{2}}), jacobians({count, py::ssize_t{2}, py::ssize_t{3}});
  for (py::ssize_t i = 0; i < count; ++i)
  {
    const double* point = points.data(i, 0);
    const Projection seen = camera.projection({point[0], point[1], point[2]});
    *pixels.mutable_data(i, 0) = seen.pixel.x;
    *pixels.mutable_data(i, 1) = seen.pixel.y;
    std::copy(seen.jacobian.val, seen.jacobian.val + 6, jacobians.mutable_data(i, 0, 0));
  }
  return py::make_tuple(pixels, jacobians);
}

void bindCamera(py::module& m)
{
  py::class_<CameraModel>(m, "CameraModel", "Pinhole camera with one of sensor_msgs/CameraInfo's distortions.")
      .def(py::init(&makeCamera), "width"_a, "height"_a, "K"_a, "D"_a = std::vector<double>(),
           "distortion_model"_a = "plumb_bob",
           "Size (px), K (3x3, px), D and its model (plumb_bob, rational_polynomial, equidistant or fisheye), as in "
           "sensor_msgs/CameraInfo.\n\nRaises ValueError for what no camera has.")
      .def_readonly("width", &CameraModel::width, "px")
      .def_readonly("height", &CameraModel::height, "px")
      .def_property_readonly(
          "K",
          [](const CameraModel& c) {
            return py::array_t<double>({3, 3}, c.K.val);
          },
          "3x3, px")
      .def_readonly("D", &CameraModel::D,
                    "k1, k2, p1, p2, k3, k4, k5, k6: the first 0, 4, 5 or 8; equidistant: k1 to k4")
      .def_readonly("distortion_model", &CameraModel::distortion_model)
      .def("project", &project, "points"_a,
           "Where points are seen, and how that changes with them: (n, 2) px and (n, 2, 3) px/m of (n, 3) m in the "
           "optical frame; NaN for those not in front of the camera.");
  m.def(
      "validate_rectification",
      [](const Matrix& R, const Matrix& P)
      {
        if (R.size() != 9 || P.size() != 12)
          throw py::value_error("R has " + std::to_string(R.size()) + " numbers and P " + std::to_string(P.size()) +
                                ", must be 9 and 12");
        validateRectification(cv::Matx33d(R.data()), cv::Matx34d(P.data()));
      },
      "R"_a, "P"_a, "Raises ValueError for what no sensor_msgs/CameraInfo has there.");
  m.def(
      "is_calibrated", [](const Matrix& K) { return isCalibrated(toK(K)); }, "K"_a,
      "Whether a sensor_msgs/CameraInfo with this K (9 numbers) is of a calibrated camera: others have zeros there.");
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
              const LeaveGil unlocked;
              scene.render(frame, bgr);
            }
            return toNumpy(bgr);
          },
          "frame"_a, "The picture of a frame: (height, width, 3) uint8, BGR.");
}

void bindCalibration(py::module& m)
{
  py::class_<CalibrationScene>(m, "CalibrationScene",
                               "A checkerboard shown to the Scene's camera, each half second in another pose.")
      .def(py::init<const SceneParams&>(), "params"_a = SceneParams())
      .def_property_readonly("camera", &CalibrationScene::camera)
      .def("truth", &CalibrationScene::truth, "frame"_a)
      .def(
          "render",
          [](const CalibrationScene& scene, std::int64_t frame)
          {
            cv::Mat bgr;
            {
              const LeaveGil unlocked;
              scene.render(frame, bgr);
            }
            return toNumpy(bgr);
          },
          "frame"_a, "The picture of a frame: (height, width, 3) uint8, BGR.");
}

py::array renderFloor(const FloorScene& scene, const Matrix& camera)
{
  if (camera.ndim() != 2 || camera.shape(0) != 4 || camera.shape(1) != 4)
    throw py::value_error("expected a 4x4 pose of the camera");
  const cv::Affine3d pose(cv::Matx44d(camera.data()));
  cv::Mat bgr;
  {
    const LeaveGil unlocked;
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
  bindCalibration(m);
  bindFloor(m);
}
