#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/depth/region_depth.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace depth_regions_bindings
{

std::vector<cv::Point2d> toOutline(const Matrix& points)
{
  if (points.size() == 0) return {};
  if (points.ndim() != 2 || points.shape(1) != 2) throw py::value_error("expected an (n, 2) array as outline");
  std::vector<cv::Point2d> outline;
  for (py::ssize_t i = 0; i < points.shape(0); ++i)
    outline.emplace_back(points.at(i, 0), points.at(i, 1));
  return outline;
}

std::optional<LocatedRegion> locate(const RegionLocator& locator, const py::array& depth, const Box& box,
                                    const std::optional<Matrix>& outline,
                                    const std::optional<std::pair<double, double>>& center, double radius)
{
  const DepthArray input(depth);
  ImageRegion region;
  region.box = toRect(box);
  if (outline) region.outline = toOutline(*outline);
  if (center) region.center = cv::Point2d(center->first, center->second);
  region.radius = radius;
  return withoutGil([&] { return locator.locate(input.view, input.encoding, region); });
}

void bindDepthRegions(py::module& m)
{
  bindParams<LocatorParams>(m, "LocatorParams", "How a RegionLocator finds where things are.");
  py::class_<LocatedRegion>(m, "LocatedRegion", "Where a thing is that was found in an image.")
      .def_property_readonly(
          "position", [](const LocatedRegion& found) { return py::array_t<double>(3, &found.position.x); },
          "(3,), m, in the camera's optical frame")
      .def_property_readonly("covariance", attribute(&LocatedRegion::covariance), "(3, 3), m^2, of the position")
      .def_property_readonly(
          "size", [](const LocatedRegion& found) { return py::array_t<double>(3, found.size.val); },
          "(3,), m, along the axes of that frame")
      .def_readonly("pixels", &LocatedRegion::pixels, "px^2, that show it with a depth");
  py::class_<RegionLocator>(m, "RegionLocator",
                            "Finds where things are that were found in the images of one camera, by the depths that "
                            "belong to these images. Threads may share one.")
      .def(py::init<const CameraModel&, const LocatorParams&, const DepthErrorParams&>(), "camera"_a,
           "params"_a = LocatorParams(), "errors"_a = DepthErrorParams(),
           "Raises ValueError for what no camera has, and a parameter out of range.")
      .def_property_readonly("camera", &RegionLocator::camera, "the CameraModel")
      .def("locate", &locate, "depth"_a, "box"_a, "outline"_a = py::none(), "center"_a = py::none(), "radius"_a = 0.0,
           "Where the thing in a box is, a LocatedRegion; None if too few of its pixels have a depth.\n\n"
           "depth: (height, width) uint16 in mm or float32 in m; box: (x, y, width, height), px; outline: (n, 2), px, "
           "closed, or None for all of the box; center: (x, y), px, or None for that of the box; radius: px, of a "
           "sphere, or 0 for that of the box.\n\n"
           "Raises ValueError for an image that is not of the camera's size, and for a region that is not in it.");
}

const Bindings kBindings("depth_regions", {"geometry", "depth"}, bindDepthRegions);

}  // namespace depth_regions_bindings
