#include <pybind11/stl.h>

#include <array>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/depth/depth_normals.hpp"
#include "robot_vision/depth/planes.hpp"
#include "robot_vision/depth/tabletop.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace depth_planes_bindings
{

/// (3,) array.
py::array_t<double> numbers(const cv::Vec3d& vector)
{
  return py::array_t<double>(3, vector.val);
}

/// (n, 3) array.
py::array_t<double> numbers(const std::vector<cv::Point3d>& points)
{
  return py::array_t<double>({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}},
                             points.empty() ? nullptr : &points[0].x);
}

void bindNormals(py::module& m)
{
  bindParams<NormalParams>(m, "NormalParams", "How DepthNormals finds normals.");
  py::class_<DepthNormals>(m, "DepthNormals",
                           "Finds the normals of the surfaces in the depth images of one camera. For one thread at a "
                           "time.")
      .def(py::init<const CameraModel&, const NormalParams&>(), "camera"_a, "params"_a = NormalParams(),
           "Raises ValueError for what no camera has, and a parameter out of range.")
      .def(
          "apply",
          [](DepthNormals& finder, const py::array& depth)
          {
            const DepthArray input(depth);
            return imageFrom([&](cv::Mat& out) { finder.apply(input.view, input.encoding, out); });
          },
          "depth"_a,
          "Unit vectors in the camera's optical frame that point to its side, (height, width, 3) float32, of depths, "
          "(height, width) uint16 in mm or float32 in m; NaN where there is no depth, and beside jumps.\n\n"
          "Raises ValueError for an image that is not of the camera's size.");
}

void bindPlanes(py::module& m)
{
  bindParams<PlaneParams>(m, "PlaneParams", "How a PlaneFinder finds planes.");
  py::class_<Plane>(m, "Plane", "A part of a plane that a depth image shows, in the camera's optical frame.")
      .def_property_readonly(
          "normal", [](const Plane& plane) { return numbers(plane.normal); }, "(3,), unit vector, to the camera's side")
      .def_readonly("distance", &Plane::distance,
                    "m, of the camera: normal @ point + distance is 0 for points of the plane")
      .def_property_readonly(
          "center", [](const Plane& plane) { return numbers(cv::Vec3d(plane.center)); },
          "(3,), m, where the mean of its pixels' rays meets it")
      .def_readonly("pixels", &Plane::pixels, "that it has")
      .def_readonly("deviation", &Plane::deviation, "of its pixels, in standard deviations of the noise")
      .def_property_readonly(
          "hull", [](const Plane& plane) { return numbers(plane.hull); },
          "(n, 3), m, corners of its convex hull, counter-clockwise for the camera");
  py::class_<PlaneFinder>(m, "PlaneFinder",
                          "Finds the planes in the depth images of one camera. For one thread at a time.")
      .def(py::init<const CameraModel&, const PlaneParams&>(), "camera"_a, "params"_a = PlaneParams(),
           "Raises ValueError for what no camera has, and a parameter out of range.")
      .def(
          "find",
          [](PlaneFinder& finder, const py::array& depth)
          {
            const DepthArray input(depth);
            const PlaneSegmentation found = withoutGil([&] { return finder.find(input.view, input.encoding); });
            return py::make_tuple(found.planes, toPython(found.labels.clone()));
          },
          "depth"_a,
          "The Planes in depths, (height, width) uint16 in mm or float32 in m, the one with most pixels first, and "
          "(height, width) uint8: 1 for pixels of the first plane, 2 of the second, ...; 0 of none.\n\n"
          "Raises ValueError for an image that is not of the camera's size.");
}

void bindTables(py::module& m)
{
  bindParams<TabletopParams>(m, "TabletopParams", "How a TabletopFinder finds tables, and what stands on them.");
  py::class_<TableObject>(m, "TableObject", "Something that stands on a table, as far as it is seen.")
      .def_property_readonly("box", attribute(&TableObject::box), "(x, y, width, height), px")
      .def_readonly("pixels", &TableObject::pixels, "that show it")
      .def_property_readonly("pose", attribute(&TableObject::pose),
                             "4x4, m, of the box around it in the camera's optical frame: the origin is its middle, z "
                             "the table's normal, x along the longer side of its footprint, to the camera's right")
      .def_property_readonly(
          "size", [](const TableObject& object) { return numbers(object.size); }, "(3,), m, of that box");
  py::class_<Table>(m, "Table", "A table, and what stands on it.")
      .def_readonly("plane", &Table::plane)
      .def_property_readonly(
          "pose", attribute(&Table::pose),
          "4x4, m, in the camera's optical frame: the origin is the middle of the smallest rectangle "
          "around its hull, x along the longer side of that, to the camera's right, z the normal")
      .def_property_readonly(
          "size", [](const Table& table) { return std::make_pair(table.size[0], table.size[1]); },
          "m, of that rectangle")
      .def_readonly("objects", &Table::objects, "the one with most pixels first");
  py::class_<TabletopFinder>(m, "TabletopFinder",
                             "Finds tables in the depth images of one camera, and what stands on them. For one thread "
                             "at a time.")
      .def(py::init<const CameraModel&, const PlaneParams&, const TabletopParams&>(), "camera"_a,
           "planes"_a = PlaneParams(), "params"_a = TabletopParams(),
           "Raises ValueError for what no camera has, and a parameter out of range.")
      .def(
          "find",
          [](TabletopFinder& finder, const py::array& depth, const std::array<double, 3>& up)
          {
            const DepthArray input(depth);
            const Tabletop found = withoutGil(
                [&] {
                  return finder.find(input.view, input.encoding, {up[0], up[1], up[2]});
                });
            return py::make_tuple(found.tables, toPython(found.labels.clone()));
          },
          "depth"_a, "up"_a = std::array<double, 3>{},
          "The Tables in depths, (height, width) uint16 in mm or float32 in m, the highest first, and (height, width) "
          "uint16: 1 for pixels of the first object of all tables, 2 of the second, ...; 0 of none. `up` is what is up "
          "in "
          "the camera's optical frame; without it the largest plane is the table.\n\n"
          "Raises ValueError for an image that is not of the camera's size.")
      .def_property_readonly(
          "planes", [](const TabletopFinder& finder) { return finder.planes().planes; }, "all of the last image");
}

void bindDepthPlanes(py::module& m)
{
  bindNormals(m);
  bindPlanes(m);
  bindTables(m);
}

const Bindings kBindings("depth_planes", {"geometry"}, bindDepthPlanes);

}  // namespace depth_planes_bindings
