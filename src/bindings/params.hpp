#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

namespace py = pybind11;

/// "side of the box blur; 1: none (px; odd and from 1 to 31)".
inline std::string fieldDoc(const std::string& limits, const std::string& unit, const std::string& meaning)
{
  const std::string both = unit + (unit.empty() || limits.empty() ? "" : "; ") + limits;
  return both.empty() ? meaning : meaning + " (" + both + ")";
}

/// Adds an attribute for each field of Params to their class, their comparison, and validate() of them to the module.
template <class Params>
void bindFields(py::module& m, py::class_<Params>& bound)
{
  Params::fields([&bound](const char* name, auto member, const auto& limits, const char* unit, const char* meaning)
                 { bound.def_readwrite(name, member, fieldDoc(limitsText(limits), unit, meaning).c_str()); });
  bound.def("__eq__", &equalFields<Params>, py::arg("other"), py::is_operator());
  m.def(
      "validate", [](const Params& params) { validate(params); }, py::arg("params"),
      "Raises ValueError naming the first parameter out of range, its value and the range.");
}

/// A class of parameters, made with their defaults.
template <class Params>
void bindParams(py::module& m, const char* name, const char* doc)
{
  py::class_<Params> bound(m, name, doc);
  bound.def(py::init<>());
  bindFields(m, bound);
}

}  // namespace robot_vision
