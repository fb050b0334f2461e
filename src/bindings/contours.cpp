#include "robot_vision/contours/contours.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace contours_bindings
{

/// Reads a point of a defect as (x, y).
auto pixel(cv::Point ContourDefect::*member)
{
  return [member](const ContourDefect& defect) { return std::pair<int, int>((defect.*member).x, (defect.*member).y); };
}

void bindParts(py::module& m)
{
  py::class_<ContourDefect>(m, "ContourDefect", "Where the hull of a contour is far from it.")
      .def_property_readonly("start", pixel(&ContourDefect::start), "(x, y), px, where the two begin to part")
      .def_property_readonly("end", pixel(&ContourDefect::end), "(x, y), px, where they meet again")
      .def_property_readonly("farthest", pixel(&ContourDefect::farthest), "(x, y), px, of the contour")
      .def_readonly("depth", &ContourDefect::depth, "px, of this point from the line between the two others");

  py::class_<TurnedShape>(m, "TurnedShape", "A rectangle or an ellipse that is turned.")
      .def_property_readonly("center", attribute(&TurnedShape::center), "(x, y), px")
      .def_readonly("length", &TurnedShape::length, "px, of the longer side or axis, from end to end")
      .def_readonly("width", &TurnedShape::width, "px, of the shorter one")
      .def_readonly("angle", &TurnedShape::angle,
                    "rad, from the x axis to the longer one, clockwise as seen; above -pi/2, up to pi/2");
}

void bindContour(py::module& m)
{
  py::class_<Contour>(m, "Contour", "A border of white pixels, and what OpenCV's functions say of it.")
      .def_property_readonly("outline", attribute(&Contour::outline), "(n, 2) int, px, closed")
      .def_readonly("parent", &Contour::parent, "index of the next one around it that was taken; -1: there is none")
      .def_readonly("depth", &Contour::depth, "number of contours around it, those left out included")
      .def_readonly("hole", &Contour::hole, "it goes around black pixels")
      .def_property_readonly("box", attribute(&Contour::box), "(x, y, width, height), px, upright")
      .def_property_readonly("center", attribute(&Contour::center), "(x, y), px, centroid of what it encloses")
      .def_readonly("area", &Contour::area, "px^2 of what it encloses, with holes")
      .def_readonly("length", &Contour::length, "px")
      .def_readonly("convex", &Contour::convex, "whether the outline is")
      .def_readonly("solidity", &Contour::solidity, "area relative to that of the hull, 0 to 1")
      .def_property_readonly("approximation", attribute(&Contour::approximation), "(n, 2) int, px, by approxPolyDP")
      .def_property_readonly("hull", attribute(&Contour::hull), "(n, 2) int, px")
      .def_readonly("defects", &Contour::defects, "ContourDefects, deepest first")
      .def_property_readonly("circle_center", attribute(&Contour::circle_center),
                             "(x, y), px, of the smallest circle around it")
      .def_readonly("circle_radius", &Contour::circle_radius, "px")
      .def_readonly("rectangle", &Contour::rectangle, "TurnedShape, the smallest around it")
      .def_readonly("ellipse", &Contour::ellipse, "TurnedShape by fitEllipse, or None")
      .def_property_readonly("line_point", attribute(&Contour::line_point), "(x, y), px, of the line by fitLine")
      .def_readonly("line_angle", &Contour::line_angle, "rad, of its direction; above -pi/2, up to pi/2")
      .def_readonly("hu", &Contour::hu, "the 7 Hu moments")
      .def_readonly("shape", &Contour::shape, "triangle, square, rectangle, ..., circle, ellipse, polygon or concave")
      .def_readonly("match", &Contour::match, "matchShapes against the template, or None; inf: not comparable")
      .def_readonly("matches", &Contour::matches, "whether this is not above max_distance")
      .def_readonly("point_distance", &Contour::point_distance, "px to the point asked for, > 0 inside");

  py::class_<ContourResult>(m, "ContourResult", "What a ContourFinder has found in an image.")
      .def_property_readonly("mask", attribute(&ContourResult::mask), "(height, width) uint8, 0 and 255")
      .def_readonly("contours", &ContourResult::contours, "the largest first");
}

std::unique_ptr<ContourFinder> makeFinder(const ContourParams& params, const std::optional<py::array>& template_bgr)
{
  std::optional<ImageArray> pattern;
  if (template_bgr) pattern.emplace(*template_bgr);
  const LeaveGil unlocked;
  return std::make_unique<ContourFinder>(params, pattern ? pattern->view : cv::Mat());
}

void bindContours(py::module& m)
{
  bindParams<ContourParams>(m, "ContourParams", "How a ContourFinder finds contours, and what it measures.");
  bindParts(m);
  bindContour(m);
  py::class_<ContourFinder>(m, "ContourFinder", "Finds contours and measures them. Not for two threads at once.")
      .def(py::init(&makeFinder), "params"_a = ContourParams(), "template_bgr"_a = py::none(),
           "template_bgr: (height, width, 3) uint8, whose largest contour others are compared with.\n\n"
           "Raises ValueError for a parameter out of range, and if the template shows no contour.")
      .def(
          "apply",
          [](ContourFinder& finder, const py::array& image, const std::string& encoding,
             const std::optional<std::pair<double, double>>& point)
          {
            const ImageArray input(image);
            std::optional<cv::Point2d> asked;
            if (point) asked.emplace(point->first, point->second);
            const LeaveGil unlocked;
            return finder.apply(input.view, encoding, asked);
          },
          "image"_a, "encoding"_a = "bgr8", "point"_a = py::none(),
          "The ContourResult of an image; point: (x, y), px, whose distance from each contour is wanted.\n\n"
          "Raises ValueError for an image that is not of this encoding.");
}

const Bindings kBindings("contours", {}, bindContours);

}  // namespace contours_bindings
