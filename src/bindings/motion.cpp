#include "robot_vision/motion/motion.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"

using namespace robot_vision;
using namespace py::literals;

/// What moves.
void bindMotion(py::module& m)
{
  py::class_<MotionParams>(
      m, "MotionParams",
      "Method (first_frame, previous_frame, running_average, mog2), Gaussian blur (odd px), "
      "threshold (grey levels), dilation (px), least area (px), learning rate (0..1), share of the "
      "picture that is no motion any more (0..1), s until that is the background.")
      .def(py::init<>())
      .def_readwrite("method", &MotionParams::method)
      .def_readwrite("blur_size", &MotionParams::blur_size)
      .def_readwrite("threshold", &MotionParams::threshold)
      .def_readwrite("dilate", &MotionParams::dilate)
      .def_readwrite("min_area", &MotionParams::min_area)
      .def_readwrite("learning_rate", &MotionParams::learning_rate)
      .def_readwrite("max_changed", &MotionParams::max_changed)
      .def_readwrite("settle", &MotionParams::settle)
      .def_readwrite("ignore_light", &MotionParams::ignore_light);

  py::class_<Motion>(m, "Motion", "What moves in a frame.")
      .def_property_readonly(
          "mask", [](const Motion& motion) { return toNumpy(motion.mask); },
          "(height, width) uint8, 255 where the picture has changed")
      .def_readonly("changed", &Motion::changed, "share of the picture that has, 0 to 1")
      .def_readonly("everywhere", &Motion::everywhere, "more than max_changed: light, or the camera; no regions")
      .def_readonly("regions", &Motion::regions, "of the mask, the largest first");

  py::class_<MotionDetector>(m, "MotionDetector", "Finds what moves by comparing each frame with a background.")
      .def(py::init<const MotionParams&>(), "params"_a = MotionParams())
      .def(
          "update",
          [](MotionDetector& detector, double time, const py::array& image, const std::string& encoding)
          {
            const Picture input(image);
            const LeaveGil unlocked;
            return detector.update(time, input.view, encoding);
          },
          "time"_a, "image"_a, "encoding"_a = "bgr8",
          "The Motion in the frame of a time, s. The first frame, one of another size and one of an earlier time are "
          "new "
          "backgrounds.\n\nRaises ValueError for an image that is not of this encoding.")
      .def("reset", &MotionDetector::reset, "The next frame is the background.");
}
