#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/stereo/rectifier.hpp"
#include "robot_vision/stereo/stereo_camera.hpp"
#include "robot_vision/stereo/stereo_matcher.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace stereo_bindings
{

template <class Result>
Result toMatrix(const Matrix& matrix, const std::string& name)
{
  constexpr py::ssize_t kCount = Result::rows * Result::cols;
  if (matrix.size() != kCount)
    throw py::value_error(name + " has " + std::to_string(matrix.size()) + " numbers, must have " +
                          std::to_string(kCount));
  return Result(matrix.data());
}

void bindCameras(py::module& m)
{
  py::class_<StereoGeometry>(m, "StereoGeometry", "What turns the disparities of rectified images into places.")
      .def_readonly("fx", &StereoGeometry::fx, "px")
      .def_readonly("fy", &StereoGeometry::fy, "px")
      .def_readonly("cx", &StereoGeometry::cx, "px, of the left image")
      .def_readonly("cy", &StereoGeometry::cy, "px")
      .def_readonly("offset", &StereoGeometry::offset, "px, the disparity of what is infinitely far away")
      .def_readonly("baseline", &StereoGeometry::baseline, "m");

  py::class_<RectifiedCamera>(m, "RectifiedCamera", "One camera of a pair, and how its images are rectified.")
      .def(py::init(
               [](const CameraModel& model, const Matrix& R, const Matrix& P)
               {
                 const RectifiedCamera camera{model, toMatrix<cv::Matx33d>(R, "R"), toMatrix<cv::Matx34d>(P, "P")};
                 validate(camera);
                 return camera;
               }),
           "model"_a, "R"_a, "P"_a,
           "A CameraModel, and R (3x3) and P (3x4, px) of its sensor_msgs/CameraInfo.\n\n"
           "Raises ValueError for what no camera of a calibrated pair has.")
      .def_readonly("model", &RectifiedCamera::model)
      .def_property_readonly("R", attribute(&RectifiedCamera::R), "3x3, from the optical to the rectified frame")
      .def_property_readonly("P", attribute(&RectifiedCamera::P), "3x4, px, of rectified images")
      .def_property_readonly("rectified", &rectifiedModel, "the CameraModel that sees the rectified images");

  py::class_<StereoCamera>(m, "StereoCamera", "Two cameras that were calibrated together.")
      .def(py::init(
               [](const RectifiedCamera& left, const RectifiedCamera& right)
               {
                 const StereoCamera pair{left, right};
                 validate(pair);
                 return pair;
               }),
           "left"_a, "right"_a, "Raises ValueError for two that are no pair.")
      .def_readonly("left", &StereoCamera::left)
      .def_readonly("right", &StereoCamera::right)
      .def_property_readonly("geometry", &geometryOf, "the StereoGeometry");
}

void bindRectifier(py::module& m)
{
  const auto apply =
      [](Rectifier& rectifier, const py::array& image, const std::string& encoding, const std::string& wanted)
  {
    const ImageArray input(image);
    return imageFrom([&](cv::Mat& out) { rectifier.apply(input.view, encoding, wanted, out); });
  };
  py::class_<Rectifier>(m, "Rectifier", "Makes the rectified images of one camera of a pair. For one thread at a time.")
      .def(py::init<const RectifiedCamera&>(), "camera"_a)
      .def("apply", apply, "image"_a, "encoding"_a = "bgr8", "wanted"_a = "bgr8",
           "The rectified image in the encoding `wanted`, bgr8 or mono8; black where the camera sees nothing.\n\n"
           "Raises ValueError for an image that is not of this encoding, or not of the camera's size.")
      .def_property_readonly("camera", &Rectifier::camera, "the RectifiedCamera")
      .def_property_readonly(
          "seen", [](const Rectifier& rectifier) { return toPython(rectifier.seen().clone()); },
          "(height, width) uint8, 255 where the camera sees something, else 0, also beyond what the lens shows");
}

py::array matched(StereoMatcher& matcher, const py::array& left, const py::array& right, const std::string& encoding,
                  const std::optional<py::array>& left_seen, const std::optional<py::array>& right_seen)
{
  const ImageArray of_left(left), of_right(right);
  std::optional<ImageArray> left_mask, right_mask;
  if (left_seen) left_mask.emplace(*left_seen);
  if (right_seen) right_mask.emplace(*right_seen);
  return imageFrom(
      [&](cv::Mat& disparity)
      {
        matcher.match(of_left.view, of_right.view, encoding, disparity, left_mask ? left_mask->view : cv::Mat(),
                      right_mask ? right_mask->view : cv::Mat());
      });
}

void bindMatcher(py::module& m)
{
  bindParams<StereoParams>(m, "StereoParams", "How a StereoMatcher finds disparities.");
  py::class_<StereoMatcher>(m, "StereoMatcher",
                            "Finds how far what is seen in the left of two rectified images is farther left in the "
                            "right one. For one thread at a time.")
      .def(py::init<const StereoParams&>(), "params"_a = StereoParams())
      .def("match", &matched, "left"_a, "right"_a, "encoding"_a = "bgr8", "left_seen"_a = py::none(),
           "right_seen"_a = py::none(),
           "The disparities of the left image's pixels: (height, width) float32, px, in steps of 1/16; NaN where none "
           "was found. There are none where the masks, (height, width) uint8, are 0.\n\n"
           "Raises ValueError for images that are not of this encoding or of two sizes, too small, or too large.")
      .def(
          "window",
          [](const StereoMatcher& matcher, int width, int height) {
            return toPython(matcher.window({width, height}));
          },
          "width"_a, "height"_a,
          "x, y, width, height of the part of a left image of this size that can have disparities");
}

void bindStereo(py::module& m)
{
  bindCameras(m);
  bindRectifier(m);
  bindMatcher(m);
}

const Bindings kBindings("stereo", {"geometry"}, bindStereo);

}  // namespace stereo_bindings
