#include <pybind11/stl.h>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/tags/pose/tag_plane.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace tags_plane_bindings
{

DepthPlane makePlane(const Matrix& inverse_depth, const Matrix& covariance, int pixels)
{
  if (inverse_depth.size() != 3 || covariance.size() != 9)
    throw py::value_error("expected 3 numbers and their 3x3 covariance");
  const DepthPlane plane{cv::Vec3d(inverse_depth.data()), cv::Matx33d(covariance.data()), pixels};
  validate(plane);
  return plane;
}

void bindTagPlane(py::module& m)
{
  py::class_<DepthPlane>(m, "DepthPlane",
                         "A plane that a depth image shows: on the ray (x, y, 1) of the camera's optical frame it has "
                         "the depth 1 / (a x + b y + c).")
      .def(py::init(&makePlane), "inverse_depth"_a, "covariance"_a, "pixels"_a = 0,
           "Raises ValueError unless all is finite and the covariance positive definite.")
      .def_property_readonly(
          "inverse_depth",
          [](const DepthPlane& plane) { return py::array_t<double>(py::ssize_t{3}, plane.inverse_depth.val); },
          "a, b and c, (3,), 1/m")
      .def_property_readonly("covariance", attribute(&DepthPlane::covariance), "3x3, of the three, 1/m^2")
      .def_readonly("pixels", &DepthPlane::pixels, "number of those whose depths agree with it");
  m.def(
      "measure_tag_plane",
      [](const py::array& depth, const Matrix& corners, const CameraModel& camera, const DepthErrorParams& params)
      {
        const DepthArray input(depth);
        const std::array<cv::Point2d, 4> around = toCorners(corners);
        const LeaveGil unlocked;
        return measureTagPlane(input.view, around, camera, params);
      },
      "depth"_a, "corners"_a, "camera"_a, "params"_a = DepthErrorParams(),
      "The DepthPlane of a tag, whose corners, (4, 2) px, counter-clockwise as seen, were found in an image of the "
      "camera, or None where there is none; see tag_plane.hpp.\n\n"
      "depth: of the camera's size, lens and frame, (height, width) uint16 in mm, or float32 in m.\n"
      "Raises ValueError for an image of another size, and for a parameter out of range.");
}

const Bindings kBindings("tags/plane", {"geometry", "depth"}, bindTagPlane);

}  // namespace tags_plane_bindings
