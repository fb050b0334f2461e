#include <pybind11/stl.h>

#include <memory>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/lanes/lane_detector.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace lanes_bindings
{

std::vector<cv::Point2d> toCurve(const Matrix& points)
{
  if (points.size() == 0) return {};
  if (points.ndim() != 2 || points.shape(1) != 2) throw py::value_error("expected an (n, 2) array of points");
  std::vector<cv::Point2d> curve;
  for (py::ssize_t i = 0; i < points.shape(0); ++i)
    curve.emplace_back(points.at(i, 0), points.at(i, 1));
  return curve;
}

void draw(const py::array& bgr, const Matrix& left, const Matrix& right)
{
  cv::Mat pixels = canvas(bgr);
  const auto left_curve = toCurve(left), right_curve = toCurve(right);
  const LeaveGil unlocked;
  drawLane(pixels, left_curve, right_curve);
}

void bindResults(py::module& m)
{
  py::class_<LaneLine>(m, "LaneLine", "One of the two lines of a lane; zero and empty if it was not found.")
      .def_readonly("found", &LaneLine::found)
      .def_readonly("confidence", &LaneLine::confidence, "0 to 1, see lane_detector.hpp")
      .def_property_readonly("points", attribute(&LaneLine::points), "(n, 2), m, on the floor: ahead and left")
      .def_property_readonly("in_image", attribute(&LaneLine::in_image), "(n, 2), px, the same points")
      .def_property_readonly("from_above", attribute(&LaneLine::from_above), "(n, 2), px of the view from above");

  py::class_<Lane>(m, "Lane", "The lane that a robot is in; zero and empty if none was found.")
      .def(py::init<>())
      .def_readonly("found", &Lane::found)
      .def_readonly("offset", &Lane::offset, "m, of the robot to the left of the lane's middle")
      .def_readonly("heading", &Lane::heading, "rad, by which the robot is turned to the left against the lane")
      .def_readonly("curvature", &Lane::curvature, "1/m, of the lane's middle, to the left positive")
      .def_readonly("width", &Lane::width, "m, between the middles of the lines")
      .def_readonly("left", &Lane::left)
      .def_readonly("right", &Lane::right)
      .def_property_readonly("middle", attribute(&Lane::middle), "(n, 2), m, on the floor: ahead and left")
      .def_property_readonly("middle_in_image", attribute(&Lane::middle_in_image), "(n, 2), px; NaN: not to be seen")
      .def_property_readonly("view", attribute(&Lane::view), "(height, width, 3) uint8, BGR, the floor from above")
      .def_property_readonly("mask", attribute(&Lane::mask), "(height, width) uint8, 255 where a line may be");
}

void bindLanes(py::module& m)
{
  bindParams<GroundParams>(m, "GroundParams", "Where a camera sees the floor, and the view from above.");
  bindParams<LaneParams>(m, "LaneParams", "What is taken for the lines of a lane.");
  bindResults(m);

  py::class_<LaneDetector>(m, "LaneDetector",
                           "Finds the lane of a road in the view of a camera that looks ahead. Threads may share one; "
                           "their calls wait for each other.")
      .def(py::init<const GroundParams&, const LaneParams&>(), "ground"_a = GroundParams(), "params"_a = LaneParams())
      .def(
          "update",
          [](LaneDetector& detector, double time, const py::array& image, const std::string& encoding,
             const CameraModel* camera)
          {
            const ImageArray input(image);
            const LeaveGil unlocked;
            return detector.update(time, input.view, encoding, camera);
          },
          "time"_a, "image"_a, "encoding"_a = "bgr8", "camera"_a = py::none(),
          "The Lane in the frame of a time, s. With ground camera the CameraModel is needed.\n\n"
          "Raises ValueError for an image that is not of this encoding, or a camera that is missing or of images of "
          "another size.")
      .def("reset", &LaneDetector::reset, Unlocked(), "Forgets where the lane was.");

  m.def("draw_lane", &draw, "image"_a, "left"_a, "right"_a,
        "Draws a lane's lines, (n, 2) px, and shades what is between them. image: (height, width, 3) uint8, BGR.");
}

const Bindings kBindings("lanes", {"geometry"}, bindLanes);

}  // namespace lanes_bindings
