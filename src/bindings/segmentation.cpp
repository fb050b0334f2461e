#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/segmentation/regions.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace segmentation_bindings
{

py::tuple findRegions(const RegionFinder& finder, const py::array& mask)
{
  const ImageArray input(mask);
  cv::Mat cleaned;
  std::vector<Region> regions;
  {
    const LeaveGil unlocked;
    cleaned = input.view.clone();
    regions = finder.apply(cleaned);
  }
  return py::make_tuple(toPython(cleaned), std::move(regions));
}

void bindSegmentation(py::module& m)
{
  bindParams<RegionParams>(m, "RegionParams", "What a RegionFinder cleans away and leaves out.");

  py::class_<Region>(m, "Region", "Pixels of a mask that touch each other; pixel centres have whole coordinates.")
      .def_property_readonly("box", attribute(&Region::box), "(x, y, width, height), px")
      .def_property_readonly("center", attribute(&Region::center), "(x, y), px, of the pixels")
      .def_readonly("area", &Region::area, "number of pixels, without holes")
      .def_property_readonly("outline", attribute(&Region::outline),
                             "(n, 2) array of int, px: the pixels along the outer border, straight parts by their ends")
      .def_property_readonly("circle_center", attribute(&Region::circle_center),
                             "(x, y), px, of the smallest circle around the outline")
      .def_readonly("circle_radius", &Region::circle_radius, "px")
      .def_readonly("roundness", &Region::roundness, "area to area of the circle half a pixel larger, 0 to 1 (a disc)");

  py::class_<RegionFinder>(m, "RegionFinder", "Cleans masks and finds the regions in them. Threads may share one.")
      .def(py::init<const RegionParams&>(), "params"_a = RegionParams())
      .def("apply", &findRegions, "mask"_a,
           "The mask opened and closed, and the list of its regions, the largest first: (mask, regions).\n\n"
           "mask: (height, width) uint8, 0 and 255; it is not modified. Raises ValueError if it is something else.");
}

const Bindings kBindings("segmentation", {}, bindSegmentation);

}  // namespace segmentation_bindings
