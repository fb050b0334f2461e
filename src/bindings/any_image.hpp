#pragma once

#include "arrays.hpp"

namespace robot_vision
{

/// The depth of a cv::Mat with the array's samples. Throws if there is none.
inline int depthOf(const py::array& array)
{
  const std::string kind = std::string(1, array.dtype().kind()) + std::to_string(array.itemsize());
  const auto* const* found = std::find(std::begin(kSampleTypes), std::end(kSampleTypes), kind);
  if (found == std::end(kSampleTypes))
    throw py::type_error("no image has pixels of " + std::string(py::str(array.dtype())));
  return static_cast<int>(found - std::begin(kSampleTypes));
}

/// Pixels whose depth and channels are those of the array, of any type that a cv::Mat can have.
inline cv::Mat viewOf(const py::array& array)
{
  const auto channels = static_cast<int>(array.ndim() == 3 ? array.shape(2) : 1);
  return {static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), CV_MAKETYPE(depthOf(array), channels),
          const_cast<void*>(array.data()), static_cast<std::size_t>(array.strides(0))};
}

/// The array, or a copy of it, with packed rows and this machine's byte order.
inline py::array inMemoryOrder(const py::array& array)
{
  const py::object dtype = array.attr("dtype");
  if (hasPackedRows(array) && dtype.attr("isnative").cast<bool>()) return array;
  return array.attr("astype")(dtype.attr("newbyteorder")("="), py::arg("order") = "C");
}

/// The array, or a copy of it, that viewOf() can view. Throws unless it has the dimensions and samples of an image.
inline py::array anyImage(const py::array& array)
{
  if (array.ndim() != 2 && array.ndim() != 3)
    throw py::value_error("expected an array of 2 or 3 dimensions, got " + std::to_string(array.ndim()));
  if (array.ndim() == 3 && (array.shape(2) < 1 || array.shape(2) > CV_CN_MAX))
    throw py::value_error("no image has " + std::to_string(array.shape(2)) + " channels");
  depthOf(array);  // before its rows are looked at: NumPy has samples of no bytes
  return inMemoryOrder(array);
}

}  // namespace robot_vision
