#include "robot_vision/line/line.hpp"

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace line_bindings
{

void bindLine(py::module& m)
{
  bindParams<LineParams>(m, "LineParams", "What is taken for a line.");

  py::class_<Line>(m, "Line", "A line to follow; all zero and empty where none was found. Pixel centres are integers.")
      .def(py::init<>())
      .def_readonly("found", &Line::found)
      .def_readonly("offset", &Line::offset, "px, centroid right of the middle of the image")
      .def_readonly("error", &Line::error, "offset in half image widths, -1 (left border) to 1")
      .def_readonly("angle", &Line::angle, "rad, direction in the image, -pi/2 to pi/2: 0 straight up, right > 0")
      .def_readonly("confidence", &Line::confidence, "0 to 1, see line.hpp")
      .def_readonly("area", &Line::area, "px^2")
      .def_property_readonly("center", attribute(&Line::center), "(x, y), px, centroid")
      .def_property_readonly("outline", attribute(&Line::outline),
                             "(n, 2) int32 array, px, corners of the outer border");

  m.def(
      "find_line",
      [](const py::array& mask, const LineParams& params, const Line& previous)
      {
        const ImageArray input(mask);
        const LeaveGil unlocked;
        return findLine(input.view, params, previous);
      },
      "mask"_a, "params"_a = LineParams(), "previous"_a = Line(),
      "The line in a mask, (height, width) uint8, not 0 on the line: the largest connected region, of several alike "
      "the one nearest to `previous`.\n\n"
      "Raises ValueError for min_area out of range or what is no such mask.");
}

const Bindings kBindings("line", {}, bindLine);

}  // namespace line_bindings
