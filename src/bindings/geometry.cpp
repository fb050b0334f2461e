#include "robot_vision/geometry/camera_model.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "arrays.hpp"
#include "registry.hpp"
#include "robot_vision/geometry/distortion_models.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace geometry_bindings
{

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

py::array_t<double> rays(const CameraModel& camera, const Matrix& pixels)
{
  if (pixels.ndim() != 2 || pixels.shape(1) != 2) throw py::value_error("expected an (n, 2) array of pixels");
  std::vector<cv::Point2d> found;
  for (py::ssize_t i = 0; i < pixels.shape(0); ++i)
    found.push_back(camera.ray({pixels.at(i, 0), pixels.at(i, 1)}));
  return toPython(found);
}

void bindGeometry(py::module& m)
{
  py::class_<CameraModel>(m, "CameraModel",
                          "Pinhole camera with one of sensor_msgs/CameraInfo's distortions. Threads may share one.")
      .def(py::init(&makeCamera), "width"_a, "height"_a, "K"_a, "D"_a = std::vector<double>(),
           "distortion_model"_a = "plumb_bob",
           "Size (px), K (3x3, px), D and its model (plumb_bob, rational_polynomial, equidistant or fisheye), as in "
           "sensor_msgs/CameraInfo.\n\nRaises ValueError for what no camera has.")
      .def_readonly("width", &CameraModel::width, "px")
      .def_readonly("height", &CameraModel::height, "px")
      .def_property_readonly("K", attribute(&CameraModel::K), "3x3, px")
      .def_readonly("D", &CameraModel::D,
                    "k1, k2, p1, p2, k3, k4, k5, k6: the first 0, 4, 5 or 8; equidistant: k1 to k4")
      .def_readonly("distortion_model", &CameraModel::distortion_model)
      .def("project", &project, "points"_a,
           "Where points are seen, and how that changes with them: (n, 2) px and (n, 2, 3) px/m of (n, 3) m in the "
           "optical frame; NaN for those not in front of the camera.")
      .def("rays", &rays, "pixels"_a,
           "The inverse of project(): x and y, (n, 2), of the rays (x, y, 1) in the optical frame that are seen at "
           "pixel positions, (n, 2); NaN where there is none.");
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
  m.def("is_distorted", &isDistorted, "camera"_a,
        "Whether a CameraModel has a lens that a pinhole has not; an equidistant one is one without any D, too.");
  m.def("is_equidistant", &isEquidistant, "distortion_model"_a,
        "Whether the name of a distortion model is that of cv2.fisheye: equidistant or fisheye.");
  m.def(
      "is_calibrated", [](const Matrix& K) { return isCalibrated(toK(K)); }, "K"_a,
      "Whether a sensor_msgs/CameraInfo with this K (9 numbers) is of a calibrated camera: others have zeros there.");
}

const Bindings kBindings("geometry", {}, bindGeometry);

}  // namespace geometry_bindings
