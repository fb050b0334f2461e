#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "arrays.hpp"

namespace robot_vision
{

/// An array of depths: uint16 in mm or float32 in m, with the view of it and its encoding.
struct DepthArray
{
  explicit DepthArray(py::array depth) : array(std::move(depth))
  {
    const bool in_metres = py::isinstance<py::array_t<float>>(array);
    if (!in_metres && !py::isinstance<py::array_t<std::uint16_t>>(array))
      throw py::type_error("expected depths of uint16 (mm) or float32 (m), got " + std::string(py::str(array.dtype())));
    if (array.ndim() != 2)
      throw py::value_error("expected a (height, width) array of depths, got one of " + std::to_string(array.ndim()) +
                            " dimensions");
    if (!hasPackedRows(array)) array = array.attr("copy")("C");
    encoding = in_metres ? "32FC1" : "16UC1";
    view = cv::Mat(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), in_metres ? CV_32FC1 : CV_16UC1,
                   const_cast<void*>(array.data()), static_cast<std::size_t>(array.strides(0)));
  }

  py::array array;
  std::string encoding;
  cv::Mat view;
};

}  // namespace robot_vision
