#pragma once

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "arrays.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"

namespace robot_vision
{

/// An (n, columns) array of a copy of the list.
template <class T, int columns>
py::array_t<T> rowsToPython(const std::vector<cv::Vec<T, columns>>& list)
{
  return py::array_t<T>({static_cast<py::ssize_t>(list.size()), py::ssize_t{columns}},
                        list.empty() ? nullptr : list[0].val);
}

/// Throws py::value_error unless an array has only integers, from `low` to `high`.
inline void requireIntegers(const py::object& object, const std::string& name, int low, int high)
{
  const auto given = py::array::ensure(object);
  const char kind = given.dtype().kind();
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  const bool fit = std::all_of(numbers.data(), numbers.data() + numbers.size(),
                               [&](double number) { return number >= low && number <= high; });
  if ((kind != 'i' && kind != 'u') || !fit)
    throw py::value_error("expected whole numbers from " + std::to_string(low) + " to " + std::to_string(high) +
                          " as " + name);
}

/// The list of an (n, columns) array; empty for None. `name` is what a message calls it.
template <class T, int columns>
std::vector<cv::Vec<T, columns>> toRows(const py::object& object, const std::string& name)
{
  if (object.is_none()) return {};
  const auto array = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(object);
  if (!array || array.ndim() != 2 || array.shape(1) != columns)
    throw py::value_error("expected an (n, " + std::to_string(columns) + ") array of " + name);
  if (std::is_integral_v<T> && array.size() > 0)
    requireIntegers(object, name, std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max());
  std::vector<cv::Vec<T, columns>> list(static_cast<std::size_t>(array.shape(0)));
  if (!list.empty()) std::memcpy(list[0].val, array.data(), list.size() * sizeof(list[0]));
  return list;
}

/// A MeshCamera of one, of a CameraModel, or of a 3x3 matrix.
inline MeshCamera toMeshCamera(const py::object& camera)
{
  if (py::isinstance<MeshCamera>(camera)) return camera.cast<MeshCamera>();
  if (py::isinstance<CameraModel>(camera)) return MeshCamera(camera.cast<const CameraModel&>());
  const Matrix K = Matrix::ensure(camera);
  if (!K || K.ndim() != 2 || K.shape(0) != 3 || K.shape(1) != 3)
    throw py::value_error("expected a MeshCamera, a CameraModel or a 3x3 matrix K");
  return cv::Matx33d(K.data());
}

}  // namespace robot_vision
