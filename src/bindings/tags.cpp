#include <pybind11/stl.h>

#include "arrays.hpp"
#include "robot_vision/tag_families.hpp"

using namespace robot_vision;
using namespace py::literals;

/// AprilTags.
void bindTags(py::module& m)
{
  py::class_<TagFamily>(m, "TagFamily", "A family of AprilTags.")
      .def_readonly("name", &TagFamily::name)
      .def_readonly("ids", &TagFamily::ids, "the tags are 0 to ids - 1")
      .def_readonly("width", &TagFamily::width, "cells, side of the picture of a tag")
      .def_readonly("width_at_border", &TagFamily::width_at_border,
                    "cells between the corners that are found: the tag's size is measured there")
      .def_readonly("distance", &TagFamily::distance, "bits by which any two tags differ at least");
  m.def("tag_families", &tagFamilies, "All TagFamilies that are known.");
  m.def("tag_family", &tagFamily, "name"_a, "The TagFamily of a name; raises ValueError naming all if it is none.");
  m.def(
      "tag_cells", [](const std::string& family, int id) { return toNumpy(tagCells(family, id)); }, "family"_a, "id"_a,
      "Picture of a tag, upright: (width, width) uint8, 0 or 255, a pixel per cell; see tag_families.hpp.\n\n"
      "The corners that are found are (width - width_at_border) / 2 cells from its edges.\n"
      "Raises ValueError for an unknown family, and for an id that it does not have.");
}
