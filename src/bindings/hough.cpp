#include "robot_vision/hough/hough.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace hough_bindings
{

void bindResults(py::module& m)
{
  py::class_<HoughLine>(m, "HoughLine", "A line, clipped to the image, or a segment of one.")
      .def_property_readonly("begin", attribute(&HoughLine::begin), "(x, y), px")
      .def_property_readonly("end", attribute(&HoughLine::end), "(x, y), px")
      .def_readonly("rho", &HoughLine::rho, "px, x cos(theta) + y sin(theta) of all its points")
      .def_readonly("theta", &HoughLine::theta, "rad, direction of its normal, from x towards y, 0 to pi")
      .def_readonly("votes", &HoughLine::votes, "edge pixels on a line; 0 of segments")
      .def_readonly("score", &HoughLine::score, "votes, of segments the length, relative to the highest; 0 to 1");

  py::class_<HoughCircle>(m, "HoughCircle", "A circle, whose centre is inside of the image.")
      .def_property_readonly("center", attribute(&HoughCircle::center), "(x, y), px")
      .def_readonly("radius", &HoughCircle::radius, "px")
      .def_readonly("votes", &HoughCircle::votes, "edge pixels on it")
      .def_readonly("score", &HoughCircle::score, "votes relative to the highest in the image, 0 to 1");

  py::class_<HoughResult>(m, "HoughResult", "What a HoughTransform has found in an image, best first.")
      .def_property_readonly("edges", attribute(&HoughResult::edges),
                             "(height, width) uint8, 255 on the edges that vote; (0, 0) if not asked for")
      .def_readonly("lines", &HoughResult::lines, "HoughLines: lines, or segments")
      .def_readonly("circles", &HoughResult::circles, "HoughCircles")
      .def_readonly("too_many_edges", &HoughResult::too_many_edges,
                    "circles were not looked for, as they could not be told from chance");
}

void bindHough(py::module& m)
{
  bindParams<HoughParams>(m, "HoughParams", "What a HoughTransform looks for, and what it counts as found.");
  bindResults(m);
  py::class_<HoughTransform>(m, "HoughTransform",
                             "Finds lines, segments and circles by their edges. Not for two threads at once.")
      .def(py::init<const HoughParams&>(), "params"_a = HoughParams())
      .def(
          "apply",
          [](HoughTransform& transform, const py::array& image, const std::string& encoding, bool with_edges)
          {
            const ImageArray input(image);
            const LeaveGil unlocked;
            return transform.apply(input.view, encoding, with_edges);
          },
          "image"_a, "encoding"_a = "bgr8", "with_edges"_a = true,
          "The HoughResult of an image.\n\nRaises ValueError for an image that is not of this encoding, or of a size "
          "for "
          "which rho and theta are too fine or too coarse.");
}

const Bindings kBindings("hough", {}, bindHough);

}  // namespace hough_bindings
