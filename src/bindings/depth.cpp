#include <pybind11/stl.h>

#include <memory>
#include <optional>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/depth/depth_points.hpp"
#include "robot_vision/depth/depth_registration.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace depth_bindings
{

void bindImages(py::module& m)
{
  bindParams<DepthErrorParams>(m, "DepthErrorParams",
                               "How wrong the distances of a depth camera are; the defaults are those of a Kinect.");
  m.def("depth_deviation", &depthDeviation, "depth"_a, "errors"_a = DepthErrorParams(),
        "The standard deviation (m) of the depth (m) of one pixel: its noise and its step.");
  m.def(
      "to_metres",
      [](const py::array& depth)
      {
        const DepthArray input(depth);
        return imageFrom([&](cv::Mat& out) { toMetres(input.view, input.encoding, out); });
      },
      "depth"_a,
      "Depths, (height, width) uint16 in mm or float32 in m, as float32 in m; NaN where there is none: 0, NaN, "
      "infinite "
      "or negative.");
  m.def(
      "to_millimetres",
      [](const py::array& depth)
      {
        const DepthArray input(depth);
        return imageFrom([&](cv::Mat& out) { toMillimetres(input.view, input.encoding, out); });
      },
      "depth"_a,
      "Depths, (height, width) uint16 in mm or float32 in m, as uint16 in mm; 0 where there is none, and beyond 65.535 "
      "m.");
  m.def(
      "odd_depth",
      [](const py::array& depth)
      {
        const DepthArray input(depth);
        return withoutGil([&] { return oddDepth(input.view, input.encoding); });
      },
      "depth"_a,
      "Why depths, (height, width) uint16 in mm or float32 in m, probably are not in that unit, or that there are "
      "none; "
      "empty if nothing is odd.");
}

void bindRegistration(py::module& m)
{
  bindParams<RegistrationParams>(m, "RegistrationParams", "How a DepthRegistration draws depths.");
  py::class_<DepthRegistration>(m, "DepthRegistration",
                                "Makes of the images of a depth camera those that it would make in the place of a "
                                "color camera. For one thread at a time.")
      .def(py::init(
               [](const CameraModel& depth_camera, const CameraModel& color_camera, const Matrix& depth_to_color,
                  const RegistrationParams& params) {
                 return std::make_unique<DepthRegistration>(depth_camera, color_camera, toPose(depth_to_color), params);
               }),
           "depth_camera"_a, "color_camera"_a, "depth_to_color"_a, "params"_a = RegistrationParams(),
           "Two CameraModels, and the 4x4 matrix that takes points (m) of the depth camera's optical frame to that of "
           "the color camera.\n\nRaises ValueError for what no camera has, a parameter out of range, and a matrix that "
           "is not a pose.")
      .def(
          "set_transform",
          [](DepthRegistration& registration, const Matrix& depth_to_color)
          { registration.setTransform(toPose(depth_to_color)); },
          "depth_to_color"_a, "Changes where the cameras are to each other. Raises as the constructor does.")
      .def(
          "apply",
          [](DepthRegistration& registration, const py::array& depth)
          {
            const DepthArray input(depth);
            return imageFrom([&](cv::Mat& out) { registration.apply(input.view, input.encoding, out); });
          },
          "depth"_a,
          "The depth of each pixel of the color camera, of the type of `depth`: uint16 in mm, 0 where there is none, "
          "or "
          "float32 in m, NaN where there is none.\n\nRaises ValueError for an image that is not of the depth camera's "
          "size.");
}

void bindPoints(py::module& m)
{
  py::class_<DepthPoints>(m, "DepthPoints", "Makes points of the depth images of one camera. Threads may share one.")
      .def(py::init<const CameraModel&>(), "camera"_a, "Raises ValueError for what no camera has.")
      .def_property_readonly("camera", &DepthPoints::camera, "the CameraModel")
      .def(
          "points",
          [](const DepthPoints& maker, const py::array& depth)
          {
            const DepthArray input(depth);
            return imageFrom([&](cv::Mat& out) { maker.points(input.view, input.encoding, out); });
          },
          "depth"_a,
          "x, y and z of each pixel in the camera's optical frame, (height, width, 3) float32, m; NaN where there is "
          "no "
          "depth.\n\nRaises ValueError for an image that is not of the camera's size.")
      .def(
          "cloud",
          [](const DepthPoints& maker, const py::array& depth, const std::optional<py::array>& bgr)
          {
            const DepthArray input(depth);
            std::optional<ImageArray> colors;
            if (bgr) colors.emplace(*bgr);
            return imageFrom(
                [&](cv::Mat& out)
                {
                  if (colors)
                    maker.cloud(input.view, input.encoding, colors->view, out);
                  else
                    maker.cloud(input.view, input.encoding, out);
                });
          },
          "depth"_a, "bgr"_a = py::none(),
          "The same with a fourth number, (height, width, 4) float32, as sensor_msgs/PointCloud2 has it: 1, or the "
          "color "
          "of the pixel of `bgr`, (height, width, 3) uint8, as the bits 0x00RRGGBB.\n\n"
          "Raises ValueError for images that are not of the camera's size.");
}

void bindDepth(py::module& m)
{
  bindImages(m);
  bindRegistration(m);
  bindPoints(m);
}

const Bindings kBindings("depth", {"geometry"}, bindDepth);

}  // namespace depth_bindings
