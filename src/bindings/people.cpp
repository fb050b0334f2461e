#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/people/people_detector.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace people_bindings
{

void bindPeople(py::module& m)
{
  bindParams<PeopleParams>(m, "PeopleParams", "How a PeopleDetector searches.");

  py::class_<Person>(m, "Person", "A person in an image.")
      .def_property_readonly("box", attribute(&Person::box), "x, y, width, height, px: the detector's window")
      .def_readonly("weight", &Person::weight, "distance from the plane of the support vector machine")
      .def_readonly("score", &Person::score, "1 / (1 + exp(-weight)), 0 to 1");

  py::class_<PeopleDetector>(m, "PeopleDetector",
                             "Finds people who stand or walk, by OpenCV's HOGDescriptor. Threads may share one.")
      .def(py::init<const PeopleParams&>(), "params"_a = PeopleParams(),
           "Raises ValueError for a parameter out of range.")
      .def(
          "detect",
          [](const PeopleDetector& detector, const py::array& image, const std::string& encoding)
          {
            const ImageArray input(image);
            const LeaveGil unlocked;
            return detector.detect(input.view, encoding);
          },
          "image"_a, "encoding"_a = "bgr8",
          "The people in an image, the surest first.\n\nRaises ValueError for an image that is not of this encoding.");
}

const Bindings kBindings("people", {}, bindPeople);

}  // namespace people_bindings
