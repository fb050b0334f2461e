#include <pybind11/stl.h>

#include <algorithm>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/stereo/depth_from_disparity.hpp"
#include "robot_vision/stereo/epipolar.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace stereo_results_bindings
{

cv::Matx33d toFundamental(const Matrix& F)
{
  if (F.size() != 9) throw py::value_error("F has " + std::to_string(F.size()) + " numbers, must have 9");
  return cv::Matx33d(F.data());
}

PairMatches toMatches(const FloatArray& left, const FloatArray& right)
{
  if (left.ndim() != 2 || left.shape(1) != 2 || right.ndim() != 2 || right.shape(1) != 2 ||
      left.shape(0) != right.shape(0))
    throw py::value_error("expected two (n, 2) arrays of points");
  PairMatches matches;
  for (py::ssize_t i = 0; i < left.shape(0); ++i)
  {
    matches.left.emplace_back(left.at(i, 0), left.at(i, 1));
    matches.right.emplace_back(right.at(i, 0), right.at(i, 1));
  }
  return matches;
}

void bindDepth(py::module& m)
{
  bindParams<StereoDepthParams>(m, "StereoDepthParams", "How the node stereo_matcher publishes depth.");
  m.def(
      "depth_from_disparity",
      [](const FloatArray& disparity, const StereoGeometry& geometry)
      {
        const cv::Mat view = floatView(disparity);
        return imageFrom([&](cv::Mat& out) { depthFromDisparity(view, geometry, out); });
      },
      "disparity"_a, "geometry"_a,
      "Distances along the optical axis of the rectified left camera, (height, width) float32, m, of disparities, px; "
      "NaN where these are NaN or not beyond geometry.offset.");
  m.def(
      "encode_depth",
      [](const FloatArray& depth, const std::string& encoding)
      {
        const cv::Mat view = floatView(depth);
        return imageFrom([&](cv::Mat& out) { encodeDepth(view, encoding, out); });
      },
      "depth"_a, "encoding"_a = "16UC1",
      "A depth, (height, width) float32, m, as 32FC1 or as 16UC1: mm, 0 for NaN and beyond 65.535 m.\n\n"
      "Raises ValueError for another encoding.");
  m.def(
      "disparity_to_colors",
      [](const FloatArray& disparity, double lowest, double highest)
      {
        const cv::Mat view = floatView(disparity);
        return imageFrom([&](cv::Mat& out) { disparityToColors(view, lowest, highest, out); });
      },
      "disparity"_a, "lowest"_a, "highest"_a,
      "Disparities, (height, width) float32, px, as a BGR image: from blue for the lowest to red for the highest, "
      "black "
      "for NaN.\n\nRaises ValueError if `highest` is not above `lowest`.");
}

/// What a function of epipolar.hpp draws of two BGR images.
template <class Draw>
auto drawing(Draw draw)
{
  return [draw](const py::array& left, const py::array& right, const EpipolarParams& params)
  {
    const ImageArray of_left(left), of_right(right);
    return imageFrom([&](cv::Mat& out) { draw(of_left.view, of_right.view, params, out); });
  };
}

void bindEpipolar(py::module& m)
{
  bindParams<EpipolarParams>(m, "EpipolarParams", "What the node stereo_matcher draws of a pair.");
  m.def(
      "match_pair",
      [](const py::array& left, const py::array& right, const std::string& encoding, int features)
      {
        const ImageArray of_left(left), of_right(right);
        const PairMatches matches =
            withoutGil([&] { return matchPair(of_left.view, of_right.view, encoding, features); });
        return py::make_tuple(toPython(matches.left), toPython(matches.right));
      },
      "left"_a, "right"_a, "encoding"_a = "bgr8", "features"_a = 500,
      "Points of two images that look alike, two (n, 2) float32 arrays, px, the most alike first.\n\n"
      "Raises ValueError for an image that is not of this encoding.");
  m.def(
      "find_fundamental",
      [](const FloatArray& left, const FloatArray& right) -> py::object
      {
        const PairMatches matches = toMatches(left, right);
        const auto found = withoutGil([&] { return findFundamental(matches); });
        if (!found) return py::none();
        py::array_t<bool> inliers(static_cast<py::ssize_t>(found->inliers.size()));
        std::copy(found->inliers.begin(), found->inliers.end(), inliers.mutable_data());
        return py::make_tuple(toPython(found->F), inliers);
      },
      "left"_a, "right"_a,
      "The fundamental matrix F, 3x3, of matches, two (n, 2) arrays, px, with right^T F left = 0, and which of them "
      "agree with it, (n,) bool; None if fewer than 15 do.");
  m.def(
      "epipolar_distances",
      [](const FloatArray& left, const FloatArray& right, const Matrix& F)
      { return epipolarDistances(toMatches(left, right), toFundamental(F)); },
      "left"_a, "right"_a, "F"_a, "The distance, px, of each right point from the line of its left point.");
  m.def(
      "rectified_fundamental", [] { return toPython(rectifiedFundamental()); },
      "The fundamental matrix of rectified images, 3x3: the line of a point is its row.");
  m.def(
      "draw_rectified_pair", drawing(&drawRectifiedPair), "left"_a, "right"_a, "params"_a = EpipolarParams(),
      "Two rectified BGR images beside each other, with lines along rows, and matches that are green where their rows "
      "are the same.\n\nRaises ValueError for images of two sizes.");
  m.def("draw_epipolar_lines", drawing(&drawEpipolarLines), "left"_a, "right"_a, "params"_a = EpipolarParams(),
        "Two BGR images beside each other, with the epipolar lines of matches by their fundamental matrix.");
}

void bindStereoResults(py::module& m)
{
  bindDepth(m);
  bindEpipolar(m);
}

const Bindings kBindings("stereo_results", {"stereo"}, bindStereoResults);

}  // namespace stereo_results_bindings
