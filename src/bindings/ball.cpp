#include "robot_vision/ball/ball.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/ball/ball_tracker.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace ball_bindings
{

using Pair = std::pair<double, double>;

/// One of the regions, or None.
py::object choose(const py::list& regions, double min_roundness, const std::optional<Pair>& expected)
{
  std::vector<BallCandidate> candidates;
  for (const py::handle region : regions)
  {
    const auto [x, y] = region.attr("center").cast<Pair>();
    candidates.push_back({{x, y}, region.attr("area").cast<double>(), region.attr("roundness").cast<double>()});
  }
  std::optional<cv::Point2d> near;
  if (expected) near = cv::Point2d(expected->first, expected->second);
  const std::optional<std::size_t> chosen = chooseBall(candidates, min_roundness, near);
  return chosen ? py::object(regions[*chosen]) : py::none();
}

void bindTracker(py::module& m)
{
  bindParams<BallTrackerParams>(m, "BallTrackerParams",
                                "What a BallTracker expects of a ball and of its measurements.");

  py::class_<BallMeasurement>(m, "BallMeasurement", "A ball found in an image: center (x, y) and radius, px.")
      .def(py::init(
               [](const Pair& center, double radius) {
                 return BallMeasurement{{center.first, center.second}, radius};
               }),
           "center"_a, "radius"_a)
      .def_property_readonly("center", attribute(&BallMeasurement::center), "(x, y), px")
      .def_readonly("radius", &BallMeasurement::radius, "px");

  py::class_<BallState>(m, "BallState", "A ball that is followed, at one time.")
      .def_property_readonly("center", attribute(&BallState::center), "(x, y), px")
      .def_property_readonly("velocity", attribute(&BallState::velocity), "(x, y), px/s; 0 in the first frame")
      .def_readonly("radius", &BallState::radius, "px")
      .def_readonly("predicted", &BallState::predicted, "not measured at this time")
      .def_property_readonly("covariance", attribute(&BallState::covariance), "4x4, of x, y and their rates");

  py::class_<BallTracker>(
      m, "BallTracker",
      "Kalman filter of a ball's centre, velocity and radius in the image. Not for two threads at once.")
      .def(py::init<const BallTrackerParams&>(), "params"_a = BallTrackerParams(),
           "Raises ValueError for a parameter out of range.")
      .def("update", &BallTracker::update, "time_s"_a, "measured"_a,
           "The BallState at a time (s), from a BallMeasurement, or predicted for None and for a measurement too far "
           "off; None once the ball is lost.\n\n"
           "Raises ValueError for numbers that are not finite.")
      .def("predict", &BallTracker::predict, "time_s"_a,
           "The BallState that update() would return at a time (s) for None, or None.")
      .def("expected", &BallTracker::expected, "time_s"_a,
           "The BallState that update() compares a measurement at a time (s) with, or None.");
}

void bindBall(py::module& m)
{
  py::class_<BallPosition>(m, "BallPosition", "Where a ball is.")
      .def_property_readonly(
          "position", [](const BallPosition& b) { return py::array_t<double>(3, &b.position.x); },
          "(3,) array, m, in the camera's optical frame")
      .def_property_readonly("center", attribute(&BallPosition::center),
                             "(x, y), px, the position as the camera sees it");
  m.def(
      "ball_position",
      [](const CameraModel& camera, const py::object& outline, double diameter)
      {
        const std::vector<cv::Point> pixels = toPoints(outline);
        const LeaveGil unlocked;
        return ballPosition(camera, pixels, diameter);
      },
      "camera"_a, "outline"_a, "diameter"_a,
      "The BallPosition of a ball of `diameter` (m) whose outermost pixels are `outline`, (n, 2) int; None if they are "
      "too few or no ball's.\n\n"
      "Raises ValueError for a camera that cannot be, a diameter that is not positive and points outside the image.");
  m.def("choose_ball", choose, "regions"_a, "min_roundness"_a = 0.7, "expected"_a = py::none(),
        "Of the regions (anything with center, area and roundness) that are round enough (0..1), the one nearest to "
        "where the ball is expected, (x, y) in px, or else the largest; None if there is none.");
  bindTracker(m);
}

const Bindings kBindings("ball", {"geometry"}, bindBall);

}  // namespace ball_bindings
