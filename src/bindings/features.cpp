#include <pybind11/stl.h>

#include <cmath>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/features/keypoint_matching.hpp"
#include "robot_vision/features/keypoints.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace features_bindings
{

/// (n,) array of what `value` gives of each keypoint.
template <class T, class Value>
auto ofEach(const Value& value)
{
  return [value](const Keypoints& keypoints)
  {
    std::vector<T> values;
    for (const cv::KeyPoint& key : keypoints.all)
      values.push_back(value(key));
    return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
  };
}

py::array_t<float> positions(const Keypoints& keypoints)
{
  std::vector<cv::Point2f> points;
  for (const cv::KeyPoint& key : keypoints.all)
    points.push_back(key.pt);
  return toPython(points);
}

/// rad; -1 stays as it is.
float angleOf(const cv::KeyPoint& key)
{
  return key.angle < 0.0F ? -1.0F : static_cast<float>(key.angle * CV_PI / 180.0);
}

void bindKeypoints(py::module& m)
{
  bindParams<KeypointParams>(m, "KeypointParams", "What finds keypoints, and the parameters of each detector.");

  py::class_<Keypoints>(m, "Keypoints", "Keypoints of an image, the strongest first.")
      .def("__len__", [](const Keypoints& keypoints) { return keypoints.all.size(); })
      .def_property_readonly("points", &positions, "(n, 2) float32, px")
      .def_property_readonly("sizes", ofEach<float>([](const cv::KeyPoint& key) { return key.size; }),
                             "(n,) float32, px, diameter of the part of the image that each stands for")
      .def_property_readonly("angles", ofEach<float>(&angleOf), "(n,) float32, rad, clockwise; -1: none")
      .def_property_readonly("responses", ofEach<float>([](const cv::KeyPoint& key) { return key.response; }),
                             "(n,) float32, how strong each is, in the detector's own measure")
      .def_property_readonly("octaves", ofEach<int>([](const cv::KeyPoint& key) { return key.octave; }),
                             "(n,) int32, of the pyramid; 0: the full image")
      .def_property_readonly("descriptors", attribute(&Keypoints::descriptors),
                             "(m, size) uint8, or float32 of sift: one for each row of `described`")
      .def_property_readonly("described", attribute(&Keypoints::described),
                             "(m, 2) float32, px, those with a descriptor");

  m.def(
      "find_keypoints",
      [](const py::array& image, const std::string& encoding, const KeypointParams& params, bool describe)
      {
        const ImageArray input(image);
        const LeaveGil unlocked;
        return findKeypoints(input.view, encoding, params, describe);
      },
      "image"_a, "encoding"_a = "bgr8", "params"_a = KeypointParams(), "describe"_a = false,
      "The Keypoints of an image, with descriptors if `describe` is true.\n\n"
      "Raises ValueError for an image that is not of this encoding, and for a parameter out of range.");
}

py::array_t<bool> inliersOf(const KeypointMatches& matches)
{
  py::array_t<bool> inliers(static_cast<py::ssize_t>(matches.inliers.size()));
  std::copy(matches.inliers.begin(), matches.inliers.end(), inliers.mutable_data());
  return inliers;
}

void bindMatching(py::module& m)
{
  bindParams<MatchParams>(m, "MatchParams", "What keypoints are matched with, and how.");

  py::class_<ReferencePose>(m, "ReferencePose", "Where a reference is in an image.")
      .def_property_readonly("homography", attribute(&ReferencePose::homography),
                             "(3, 3), of px of the reference to px of the image")
      .def_property_readonly("outline", attribute(&ReferencePose::outline),
                             "(4, 2) px: what is its top left, top right, bottom right, bottom left")
      .def_property_readonly("center", attribute(&ReferencePose::center), "(x, y), px, of its middle");

  py::class_<KeypointMatches>(m, "KeypointMatches", "Points of a reference, and those of the image that look alike.")
      .def("__len__", [](const KeypointMatches& matches) { return matches.from.size(); })
      .def_property_readonly("reference_points", attribute(&KeypointMatches::from), "(n, 2) float32, px")
      .def_property_readonly("points", attribute(&KeypointMatches::to), "(n, 2) float32, px, in the image")
      .def_readonly(
          "distances", &KeypointMatches::distances,
          "of the descriptors: bits, of sift Euclidean; by flow: px, by which each misses itself there and back")
      .def_property_readonly("inliers", &inliersOf, "(n,) bool, those that agree with the pose")
      .def_readonly("pose", &KeypointMatches::pose, "the ReferencePose; None if too few agree on one");

  py::class_<MatchedFrame>(m, "MatchedFrame", "What a KeypointMatcher finds in a frame.")
      .def_readonly("keypoints", &MatchedFrame::keypoints)
      .def_readonly("matches", &MatchedFrame::matches);

  m.def("match_keypoints", &matchKeypoints, "reference"_a, "image"_a, "params"_a = MatchParams(), Unlocked(),
        "The KeypointMatches of two Keypoints with descriptors, without a pose.\n\n"
        "Raises ValueError for a parameter out of range, for descriptors of two kinds, and for the matcher by flow, "
        "which compares none.");

  py::class_<KeypointMatcher>(m, "KeypointMatcher",
                              "Finds keypoints in frames, and matches them with those of a reference or of the frame "
                              "before, or follows those of the frame before. Not for two threads at once.")
      .def(py::init<const KeypointParams&, const MatchParams&>(), "keypoints"_a = KeypointParams(),
           "params"_a = MatchParams())
      .def("set_reference", withArray(&KeypointMatcher::setReference), "image"_a, "encoding"_a = "bgr8",
           "Sets the image that is looked for.\n\nRaises ValueError if it has too few keypoints.")
      .def(
          "update",
          [](KeypointMatcher& matcher, const py::array& image, const std::string& encoding, bool matches)
          {
            const ImageArray input(image);
            const LeaveGil unlocked;
            return matcher.update(input.view, encoding, matches);
          },
          "image"_a, "encoding"_a = "bgr8", "matches"_a = true,
          "The MatchedFrame of a frame, without matches if these are not wanted.\n\n"
          "Raises ValueError for an image that is not of this encoding.")
      .def("reset", &KeypointMatcher::reset, "Forgets the last frame.");
}

void bindFeatures(py::module& m)
{
  bindKeypoints(m);
  bindMatching(m);
}

const Bindings kBindings("features", {}, bindFeatures);

}  // namespace features_bindings
