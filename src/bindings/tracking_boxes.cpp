#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <tuple>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/tracking/assignment.hpp"
#include "robot_vision/tracking/box_tracker.hpp"
#include "robot_vision/tracking/camera_motion.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace tracking_boxes_bindings
{

using Corners = std::array<double, 4>;  // x0, y0, x1, y1
using Detections = std::vector<std::tuple<int, double, Corners>>;

cv::Rect2d toBox(const Corners& corners)
{
  return {corners[0], corners[1], corners[2] - corners[0], corners[3] - corners[1]};
}

std::tuple<double, double, double, double> cornersOf(const cv::Rect2d& box)
{
  return {box.x, box.y, box.x + box.width, box.y + box.height};
}

std::vector<BoxDetection> toDetections(const Detections& found)
{
  std::vector<BoxDetection> detections;
  detections.reserve(found.size());
  for (const auto& [class_id, score, corners] : found)
    detections.push_back({class_id, score, toBox(corners)});
  return detections;
}

std::optional<cv::Matx23d> toWarp(const std::optional<Matrix>& warp)
{
  if (!warp) return std::nullopt;
  if (warp->ndim() != 2 || warp->shape(0) != 2 || warp->shape(1) != 3)
    throw py::value_error("expected warp as a (2, 3) array");
  return cv::Matx23d(warp->data());
}

void bindTrack(py::module& m)
{
  py::class_<BoxTrack>(m, "BoxTrack", "One track in a frame.")
      .def_readonly("id", &BoxTrack::id, "1, 2, ...; never used again")
      .def_readonly("class_id", &BoxTrack::class_id, "that most of its detections had")
      .def_readonly("score", &BoxTrack::score, "of its last detection, 0 to 1")
      .def_property_readonly(
          "box", [](const BoxTrack& track) { return cornersOf(track.box); }, "(x0, y0, x1, y1), px, filtered")
      .def_property_readonly("velocity", attribute(&BoxTrack::velocity),
                             "(vx, vy), px/s of the centre, without the camera's motion where that is known")
      .def_readonly("predicted", &BoxTrack::predicted, "not seen in this frame")
      .def_readonly("lost", &BoxTrack::lost, "the newest result did not have it")
      .def_readonly("age", &BoxTrack::age, "s since it was seen")
      .def_readonly("detection", &BoxTrack::detection, "index of its detection in the list of update(); -1: none");
}

void bindTracker(py::module& m)
{
  py::class_<BoxTracker>(m, "BoxTracker",
                         "Gives the boxes that a detector finds ids that stay, in the manner of ByteTrack, and tells "
                         "where they are in frames that it does not see. Call predict() for each frame, and update() "
                         "when a result is there, which may be of an earlier frame. Not for two threads at once.")
      .def(py::init<const BoxTrackerParams&>(), "params"_a = BoxTrackerParams())
      .def("configure", &BoxTracker::configure, "params"_a,
           "Parameters from the next call on; tracks stay.\n\nRaises ValueError for one out of range.")
      .def(
          "update",
          [](BoxTracker& tracker, double time_s, const Detections& detections, const std::optional<Matrix>& warp)
          {
            const std::vector<BoxDetection> found = toDetections(detections);
            const std::optional<cv::Matx23d> moved = toWarp(warp);
            return withoutGil([&] { return tracker.update(time_s, found, moved); });
          },
          "time_s"_a, "detections"_a, "warp"_a = py::none(),
          "The BoxTracks in the frame at `time_s` by a detector's result for it: a list of (class_id, score, (x0, y0, "
          "x1, y1)), px. The frame is a new one, or one that predict() was called for.\n\n"
          "warp: (2, 3), takes pixels of the newest frame to those of this one, if it is new; None: the camera does "
          "not move.\n\n"
          "Raises ValueError, and changes nothing, for a time, score, box or warp that is none, and for a warp of a "
          "frame of the past.")
      .def(
          "predict",
          [](BoxTracker& tracker, double time_s, const std::optional<Matrix>& warp)
          {
            const std::optional<cv::Matx23d> moved = toWarp(warp);
            return withoutGil([&] { return tracker.predict(time_s, moved); });
          },
          "time_s"_a, "warp"_a = py::none(),
          "Where the BoxTracks are expected in the frame at `time_s`, which is a new one or again the newest.\n\n"
          "warp and errors: as of update().")
      .def_property_readonly("left_out", &BoxTracker::leftOut,
                             "detections of the last result that there was no room for, or which had no area")
      .def("clear", &BoxTracker::clear, "Forgets all tracks; ids go on.");
}

void bindMotion(py::module& m)
{
  bindParams<CameraMotionParams>(m, "CameraMotionParams", "How a CameraMotion is found.");

  py::class_<CameraMotion>(m, "CameraMotion",
                           "How the camera's motion has moved the image since the last frame, by points that are "
                           "followed. Not for two threads at once.")
      .def(py::init<const CameraMotionParams&>(), "params"_a = CameraMotionParams())
      .def(
          "update",
          [](CameraMotion& motion, const py::array& image, const std::string& encoding,
             const std::vector<Corners>& leave_out)
          {
            const ImageArray input(image);
            std::vector<cv::Rect2d> boxes;
            for (const Corners& corners : leave_out)
              boxes.push_back(toBox(corners));
            return toPython(withoutGil([&] { return motion.update(input.view, encoding, boxes); }));
          },
          "image"_a, "encoding"_a = "bgr8", "leave_out"_a = std::vector<Corners>(),
          "(2, 3) float64 that takes pixels of the last frame to those of this one; the identity when that cannot be "
          "told, see known. leave_out: boxes (x0, y0, x1, y1) px in the last frame of what moves by itself.\n\n"
          "Raises ValueError for an image that is not of this encoding.")
      .def_property_readonly("known", &CameraMotion::known, "whether the last update() could tell the motion")
      .def_property_readonly("points", &CameraMotion::points, "that agree on the motion, in the last update()")
      .def("reset", &CameraMotion::reset, "Forgets the last frame.");
}

void bindBoxes(py::module& m)
{
  m.def(
      "best_assignment",
      [](const Matrix& gains)
      {
        if (gains.ndim() != 2) throw py::value_error("expected gains as an array of 2 dimensions");
        const cv::Mat_<double> view(static_cast<int>(gains.shape(0)), static_cast<int>(gains.shape(1)),
                                    const_cast<double*>(gains.data()));
        return withoutGil([&] { return bestAssignment(view); });
      },
      "gains"_a,
      "The column of each row of (n, m) gains, -1 for none, so that their sum is the largest there is; no pair has a "
      "gain of 0 or less.\n\nRaises ValueError for NaN and what is not from -1e12 to 1e12.");
  bindParams<BoxTrackerParams>(m, "BoxTrackerParams", "How a BoxTracker associates and predicts.");
  bindTrack(m);
  bindTracker(m);
  bindMotion(m);
}

const Bindings kBindings("tracking/boxes", {}, bindBoxes);

}  // namespace tracking_boxes_bindings
