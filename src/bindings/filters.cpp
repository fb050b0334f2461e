#include "robot_vision/filters/brightness.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/filters/filter_chain.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace filters_bindings
{

py::array applyChain(FilterChain& chain, const py::array& image, const std::string& encoding, const py::object& second,
                     const std::string& second_encoding)
{
  const ImageArray input(image);
  const ImageArray other(second.is_none() ? image : second.cast<py::array>());
  const std::string& other_encoding = second.is_none() ? encoding : second_encoding;
  return imageFrom([&](cv::Mat& output) { chain.apply({input.view, encoding}, output, {other.view, other_encoding}); });
}

std::string limitsOf(const OperationParam& param)
{
  return std::visit([](const auto& limits) { return limitsText(limits); }, param.limits);
}

void bindOperations(py::module& m)
{
  py::class_<OperationParam>(m, "OperationParam", "A parameter of an operation.")
      .def_readonly("name", &OperationParam::name)
      .def_readonly("initial", &OperationParam::initial, "its default, whose type is the parameter's")
      .def_property_readonly("limits", &limitsOf, "in words; empty for anything of that type")
      .def_readonly("unit", &OperationParam::unit)
      .def_readonly("meaning", &OperationParam::meaning)
      .def_property_readonly(
          "doc", [](const OperationParam& param) { return fieldDoc(limitsOf(param), param.unit, param.meaning); },
          "meaning, unit and limits in one line");
  py::class_<Operation>(m, "Operation", "An operation on images, which gives what OpenCV's functions give.")
      .def_readonly("name", &Operation::name)
      .def_readonly("meaning", &Operation::meaning)
      .def_readonly("encodings", &Operation::encodings, "that it takes; others are converted to bgr8 or mono8")
      .def_readonly("output", &Operation::output, "the encoding of its results; empty: that of its input")
      .def_readonly("second", &Operation::second,
                    "the encoding of a second image that it takes; 'input': that of the first; empty: it takes none")
      .def_readonly("params", &Operation::params);
  m.def("operations", &operations, "All operations, ordered by name.");
  py::class_<FilterChain>(
      m, "FilterChain",
      "Operations on images, one after the other. `values` are parameters by the name of the "
      "operation and their own (gaussian_size). Threads may share one; their calls wait for each other.")
      .def(py::init<const std::vector<std::string>&, const ParamValues&>(), "chain"_a, "values"_a = ParamValues())
      .def("apply", &applyChain, "image"_a, "encoding"_a = "bgr8", "second"_a = py::none(),
           "second_encoding"_a = "bgr8",
           "The result for an image. Operations on two images take `second` as the other one, or else the same.\n\n"
           "Raises ValueError for an image that is not of its encoding, and, naming the operation, if one cannot be "
           "done on it.");
}

void bindFilters(py::module& m)
{
  bindParams<BrightnessParams>(m, "BrightnessParams", "What adjust_brightness() does.");
  m.def(
      "adjust_brightness", applyFilter<Brightness, BrightnessParams>, "image"_a, "encoding"_a = "bgr8",
      "params"_a = BrightnessParams(),
      "255 * (clip(gain * image + offset) / 255) ** gamma, in the image's own encoding, or bgr8 for Bayer and YUV.\n\n"
      "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
  bindOperations(m);
}

const Bindings kBindings("filters", {}, bindFilters);

}  // namespace filters_bindings
