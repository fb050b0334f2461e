#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/codes/code_reader.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace codes_bindings
{

void bindCodes(py::module& m)
{
  bindParams<CodeReaderParams>(m, "CodeReaderParams", "What a CodeReader looks for, and how.");

  py::class_<Code>(m, "Code", "A code in an image.")
      .def_readonly("type", &Code::type, "one of code_types()")
      .def_property_readonly(
          "data", [](const Code& code) { return py::bytes(code.data); }, "its content, bytes of any value")
      .def_property_readonly("polygon", attribute(&Code::polygon),
                             "(4, 2) px; of a QR code the corners of its modules, clockwise from its own top left one")
      .def_readonly("score", &Code::score, "0 to 1: how sure it is");

  py::class_<CodeReader, std::unique_ptr<CodeReader, DeleteUnlocked<CodeReader>>>(
      m, "CodeReader", "Reads QR codes and bar codes. Not for two threads at once.")
      .def(py::init<const CodeReaderParams&>(), "params"_a = CodeReaderParams())
      .def("read", withArray(&CodeReader::read), "image"_a, "encoding"_a = "bgr8",
           "The Codes in an image by itself.\n\nRaises ValueError for an image that is not of this encoding.")
      .def("update", withArray(&CodeReader::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The Codes in the frame of a time, s: a new one within max_search_period.\n\n"
           "Raises ValueError for an image that is not of this encoding.");
  m.def("keeps_bytes", &keepsBytes,
        "Whether the bytes of a QR code come back as they are; by a zbar before 0.23.1 what is not ASCII may not.");
  m.def("code_types", &codeTypes, "Names of the kinds of code that can be read.");
}

const Bindings kBindings("codes", {}, bindCodes);

}  // namespace codes_bindings
