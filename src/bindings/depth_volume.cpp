#include "robot_vision/depth/depth_volume.hpp"

#include <pybind11/stl.h>

#include <array>
#include <memory>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/depth/depth_image.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace depth_volume_bindings
{

using Vector = std::array<double, 3>;

std::unique_ptr<DepthVolume> makeVolume(const Vector& low, const Vector& high, double voxel, double floor)
{
  return std::make_unique<DepthVolume>(
      VolumeParams{{low[0], low[1], low[2]}, {high[0], high[1], high[2]}, voxel, floor});
}

void addView(DepthVolume& volume, const py::array& bgr, const py::array& depth, const py::array& mask,
             const CameraModel& camera, const Matrix& pose)
{
  const ImageArray image(bgr), own(mask);
  const DepthArray depths(depth);
  const cv::Affine3d place = toPose(pose);
  const LeaveGil unlocked;
  cv::Mat metres;
  toMetres(depths.view, depths.encoding, metres);
  volume.add(image.view, metres, own.view, camera, place);
}

void bindVolume(py::module& m)
{
  py::class_<DepthVolume>(m, "DepthVolume",
                          "Makes a mesh of depth images of an object from known poses. Not for two threads at once.")
      .def(py::init(&makeVolume), "low"_a, "high"_a, "voxel"_a, "floor"_a = 0.0,
           "low, high: m, corners of a box around the object, in its frame; voxel: m, side of the cubes that it is "
           "divided into; floor: m, z below which depths are those of what it stands on.\n\n"
           "Raises ValueError for a box without an inside, and for too many cubes.")
      .def(
          "add", &addView, "bgr"_a, "depth"_a, "mask"_a, "camera"_a, "pose"_a,
          "Adds what a camera sees. depth: uint16 in mm or float32 in m; mask: uint8, not 0 where the object is; pose: "
          "4x4, object in the camera's optical frame, m.")
      .def("mesh", &DepthVolume::mesh, py::call_guard<LeaveGil>(),
           "The Mesh, closed, with the colors of its vertices. Raises ValueError if no surface is there.");
}

const Bindings kBindings("depth_volume", {"geometry", "meshes"}, bindVolume);

}  // namespace depth_volume_bindings
