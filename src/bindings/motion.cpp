#include "robot_vision/motion/motion.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace motion_bindings
{

void bindMotion(py::module& m)
{
  bindParams<MotionParams>(m, "MotionParams", "What a MotionDetector compares frames with, and what counts as motion.");

  py::class_<Motion>(m, "Motion", "What moves in a frame.")
      .def_property_readonly("mask", attribute(&Motion::mask), "(height, width) uint8, 255 where the image has changed")
      .def_readonly("changed", &Motion::changed, "share of the image that has, 0 to 1")
      .def_readonly("everywhere", &Motion::everywhere, "more than max_changed: light, or the camera; no regions")
      .def_readonly("regions", &Motion::regions, "of the mask, the largest first");

  py::class_<MotionDetector>(m, "MotionDetector",
                             "Finds what moves by comparing each frame with a background. Threads may share one; their "
                             "calls wait for each other.")
      .def(py::init<const MotionParams&>(), "params"_a = MotionParams())
      .def("configure", &MotionDetector::configure, "params"_a, Unlocked(),
           "Parameters from the next frame on. The background stays, but not for another method.\n\nRaises ValueError "
           "for one out of range.")
      .def("update", withArray(&MotionDetector::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The Motion in the frame of a time, s. The first frame, one of another size and one of an earlier time are "
           "new backgrounds.\n\nRaises ValueError for an image that is not of this encoding, and for a time that is "
           "not finite.")
      .def("reset", &MotionDetector::reset, Unlocked(), "The next frame is the background.");
}

const Bindings kBindings("motion", {"segmentation"}, bindMotion);

}  // namespace motion_bindings
