#include "robot_vision/tracking/object_tracker.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/tracking/window_tracker.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace tracking_bindings
{

py::tuple toTuple(const std::vector<FlowPoint>& flow)
{
  std::vector<cv::Point2f> positions, velocities;
  for (const FlowPoint& point : flow)
  {
    positions.push_back(point.position);
    velocities.push_back(point.velocity);
  }
  return py::make_tuple(toPython(positions), toPython(velocities));
}

void bindResult(py::module& m)
{
  py::class_<TrackedObject>(m, "TrackedObject", "An object in a frame; if it is lost, as it was when last seen.")
      .def_readonly("id", &TrackedObject::id)
      .def_readonly("label", &TrackedObject::label)
      .def_readonly("tracked", &TrackedObject::tracked, "seen in this frame; else lost")
      .def_property_readonly("outline", attribute(&TrackedObject::outline),
                             "(4, 2) px: what was the region's top left, top right, bottom right, bottom left")
      .def_property_readonly("center", attribute(&TrackedObject::center), "(x, y), px")
      .def_readonly("scale", &TrackedObject::scale, "size, 1 when it was selected")
      .def_readonly("angle", &TrackedObject::angle, "rad, by which it has turned since, clockwise")
      .def_property_readonly("velocity", attribute(&TrackedObject::velocity), "px/s of the centre")
      .def_readonly("confidence", &TrackedObject::confidence, "share of its points that are seen, 0 to 1")
      .def_property_readonly("points", attribute(&TrackedObject::points), "(n, 2) float32 px, those seen");
}

void bindWindowTracker(py::module& m)
{
  bindParams<WindowTrackerParams>(m, "WindowTrackerParams", "How a WindowTracker follows an object by its colours.");

  py::class_<TrackedWindow>(m, "TrackedWindow", "The object in a frame; if it is lost, as it was when last seen.")
      .def_readonly("id", &TrackedWindow::id)
      .def_readonly("label", &TrackedWindow::label)
      .def_readonly("tracked", &TrackedWindow::tracked, "seen in this frame; else lost")
      .def_readonly("predicted", &TrackedWindow::predicted, "lost, but expected at outline and center")
      .def_property_readonly("window", attribute(&TrackedWindow::window), "(x, y, width, height), px, as of OpenCV")
      .def_property_readonly("outline", attribute(&TrackedWindow::outline),
                             "(4, 2) px: corners of the window, or of CamShift's rotated rectangle")
      .def_property_readonly("center", attribute(&TrackedWindow::center), "(x, y), px, centre of mass")
      .def_readonly("scale", &TrackedWindow::scale, "size, 1 when it was selected")
      .def_readonly("angle", &TrackedWindow::angle, "rad, by which it has turned since, clockwise")
      .def_property_readonly("velocity", attribute(&TrackedWindow::velocity), "px/s of the centre")
      .def_readonly("confidence", &TrackedWindow::confidence, "mean of the back projection in the outline, 0 to 1");

  py::class_<WindowTracker>(m, "WindowTracker",
                            "Follows one selected object by its colours, with meanShift or CamShift, and searches for "
                            "it while it is lost. Not for two threads at once.")
      .def(py::init<const WindowTrackerParams&>(), "params"_a = WindowTrackerParams())
      .def(
          "configure",
          [](WindowTracker& tracker, const WindowTrackerParams& params)
          {
            const LeaveGil unlocked;
            tracker.configure(params);
          },
          "params"_a, "Parameters from the next frame on; the object stays.\n\nRaises ValueError for one out of range.")
      .def(
          "select",
          [](WindowTracker& tracker, const Box& box, const std::string& label)
          {
            const LeaveGil unlocked;
            return tracker.select(toRect(box), label);
          },
          "box"_a, "label"_a = "",
          "Selects what is in a box (x, y, width, height; px) of the newest frame, in place of the object before; its "
          "id.\n\nRaises ValueError if there is no frame, the box is not inside of it or too small, or if what is in "
          "it "
          "has no colours to be followed by.")
      .def("forget", &WindowTracker::forget, "id"_a, "Forgets the object; whether there was one with this id.")
      .def("update", withArray(&WindowTracker::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The TrackedWindows in the frame of a time, s: one, or none.\n\n"
           "Raises ValueError for an image that is not of this encoding.")
      .def("objects", &WindowTracker::objects, "The object as update() has returned it, or as it was selected since.")
      .def(
          "back_projection",
          [](const WindowTracker& tracker) -> py::object
          {
            const cv::Mat projection = tracker.backProjection();
            if (projection.empty()) return py::none();
            return toPython(projection);
          },
          "(height, width) uint8 of the newest frame, 255 for the most frequent colour; None without an object.");
}

void bindTracking(py::module& m)
{
  bindParams<ObjectTrackerParams>(m, "ObjectTrackerParams",
                                  "How an ObjectTracker follows objects and searches for lost ones.");
  bindResult(m);
  py::class_<ObjectTracker>(m, "ObjectTracker",
                            "Follows selected objects from frame to frame, says when they are lost, and finds them "
                            "again. Not for two threads at once.")
      .def(py::init<const ObjectTrackerParams&>(), "params"_a = ObjectTrackerParams())
      .def("configure", &ObjectTracker::configure, "params"_a,
           "Parameters from the next frame on; objects stay.\n\nRaises ValueError for one out of range.")
      .def(
          "select",
          [](ObjectTracker& tracker, const Box& box, const std::string& label)
          {
            const LeaveGil unlocked;
            return tracker.select(toRect(box), label);
          },
          "box"_a, "label"_a = "",
          "Selects what is in a box (x, y, width, height; px) of the newest frame; its id.\n\nRaises ValueError if "
          "there is no frame, the box is not inside of it, is too small, or has no features.")
      .def(
          "select_in",
          [](ObjectTracker& tracker, const py::array& image, const Box& box, const std::string& label,
             const std::string& encoding)
          {
            const ImageArray input(image);
            const LeaveGil unlocked;
            return tracker.select(input.view, encoding, toRect(box), label);
          },
          "image"_a, "box"_a, "label"_a = "", "encoding"_a = "bgr8",
          "Selects what is in a box of a frame of the past; it is lost until it is found in the next frame. Its "
          "id.\n\nRaises ValueError as select() does.")
      .def("forget", &ObjectTracker::forget, "id"_a, "Forgets an object; whether there was one.")
      .def("clear", &ObjectTracker::clear, "Forgets all objects.")
      .def("update", withArray(&ObjectTracker::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The TrackedObjects in the frame of a time, s, in the order in which they were selected.\n\n"
           "Raises ValueError for an image that is not of this encoding.")
      .def("objects", &ObjectTracker::objects, "The objects as update() has returned them, and those selected since.")
      .def(
          "flow",
          [](ObjectTracker& tracker, int count) { return toTuple(withoutGil([&] { return tracker.flow(count); })); },
          "count"_a = 200,
          "How the image has moved to the newest frame: positions (n, 2) px and velocities (n, 2) px/s of up to "
          "`count` of its points.");
}

void bindTrackers(py::module& m)
{
  bindTracking(m);
  bindWindowTracker(m);
}

const Bindings kBindings("tracking", {}, bindTrackers);

}  // namespace tracking_bindings
