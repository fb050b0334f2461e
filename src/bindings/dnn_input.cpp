#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/dnn/network_input.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace dnn_input_bindings
{

/// The array's own numbers.
cv::Mat viewOf(const py::array& out)
{
  if (!py::isinstance<py::array_t<float>>(out))
    throw py::type_error("out: expected an array of float32, got " + std::string(py::str(out.dtype())));
  if (out.ndim() != 4)
    throw py::value_error("out: expected an array of 4 dimensions, got " + std::to_string(out.ndim()));
  if (!out.writeable()) throw py::value_error("out is read-only");
  if ((out.flags() & py::array::c_style) == 0) throw py::value_error("out has gaps, or its axes are turned");
  const std::vector<int> shape(out.shape(), out.shape() + out.ndim());
  return {static_cast<int>(shape.size()), shape.data(), CV_32F, const_cast<void*>(out.data())};
}

InputPlacement fill(const py::array& image, const std::optional<Box>& part, const InputParams& params,
                    const py::array& out)
{
  const ImageArray input(image);
  cv::Mat view = viewOf(out);
  const cv::Rect rect = part ? toRect(*part) : cv::Rect({0, 0}, input.view.size());
  const LeaveGil unlocked;
  return fillInput(input.view, rect, params, view);
}

void bindInput(py::module& m)
{
  bindParams<InputParams>(m, "InputParams", "How a network wants its input.");

  py::class_<InputPlacement>(m, "InputPlacement",
                             "Where a part of an image is in a network's input: x of the input is "
                             "scale_x * (x of the image - x) + left, with (0, 0) at the corner of both.")
      .def(py::init([](double scale_x, double scale_y, double left, double top, int x, int y)
                    { return InputPlacement{scale_x, scale_y, left, top, x, y}; }),
           "scale_x"_a = 1.0, "scale_y"_a = 1.0, "left"_a = 0.0, "top"_a = 0.0, "x"_a = 0, "y"_a = 0)
      .def_readwrite("scale_x", &InputPlacement::scale_x, "px of the input for one of the image")
      .def_readwrite("scale_y", &InputPlacement::scale_y, "px of the input for one of the image")
      .def_readwrite("left", &InputPlacement::left, "px of the input, where the part begins")
      .def_readwrite("top", &InputPlacement::top, "px of the input, where the part begins")
      .def_readwrite("x", &InputPlacement::x, "px of the image, where the part begins")
      .def_readwrite("y", &InputPlacement::y, "px of the image, where the part begins");

  m.def("fill_input", fill, "image"_a, "roi"_a, "params"_a, "out"_a,
        "Writes a bgr8 image, or its region (x, y, width, height), into a network's input: resized, in the network's "
        "order of channels, normalised and padded. `out` is a float32 array of (1, 3, height, width) or, for nhwc, "
        "(1, height, width, 3).\n\nReturns the InputPlacement. Raises ValueError for parameters out of range, an image "
        "that is not bgr8, a region that is not inside of it, and an array of another shape, TypeError for one of "
        "another type.");
}

const Bindings kBindings("dnn_input", {}, bindInput);

}  // namespace dnn_input_bindings
