#pragma once

#include <string>

#include "arrays.hpp"
#include "leave_gil.hpp"

namespace robot_vision
{

/// What a filter of the core makes of an array. `Filter` is made of Params and has apply().
template <class Filter, class Params>
py::array applyFilter(const py::array& image, const std::string& encoding, const Params& params)
{
  const ImageArray input(image);
  cv::Mat output;
  {
    const LeaveGil unlocked;
    Filter(params).apply(input.view, encoding, output);
  }
  return toNumpy(output);
}

}  // namespace robot_vision
