#pragma once

#include <pybind11/stl.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "mesh_arrays.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"
#include "robot_vision/recognition/symmetry.hpp"

namespace robot_vision
{

using Vector = std::array<double, 3>;

/// (axis, fold) of each.
using Symmetries = std::vector<std::pair<Vector, int>>;

inline std::vector<Symmetry> toSymmetries(const Symmetries& pairs)
{
  std::vector<Symmetry> symmetries;
  for (const auto& [axis, fold] : pairs)
    symmetries.push_back({cv::Vec3d(axis[0], axis[1], axis[2]), fold});
  return symmetries;
}

/// (point, direction) of each axis.
inline std::vector<std::pair<Vector, Vector>> axesToPython(const std::vector<FreeAxis>& axes)
{
  std::vector<std::pair<Vector, Vector>> pairs;
  for (const FreeAxis& axis : axes)
    pairs.push_back(
        {{axis.point[0], axis.point[1], axis.point[2]}, {axis.direction[0], axis.direction[1], axis.direction[2]}});
  return pairs;
}

/// A frame with the arrays that its images are views of.
class ArrayFrame : public RecognitionFrame
{
public:
  explicit ArrayFrame(const CameraModel& camera) : RecognitionFrame(camera) {}

  void setArrays(const py::object& bgr, const py::object& depth)
  {
    cv::Mat colors, depths;
    std::string encoding = "32FC1";
    py::object kept = py::none();
    if (!bgr.is_none())
    {
      const ImageArray image(bgr);
      colors = image.view;
      kept = image.array;
    }
    if (depth.is_none())
    {
      const LeaveGil unlocked;
      set(colors, depths, encoding);
    }
    else
    {
      const DepthArray array(depth);
      const LeaveGil unlocked;
      set(colors, array.view, array.encoding);
    }
    bgr_array_ = kept;
  }

private:
  py::object bgr_array_ = py::none();
};

}  // namespace robot_vision
