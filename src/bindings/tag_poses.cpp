#include <pybind11/stl.h>

#include <map>

#include "arrays.hpp"
#include "robot_vision/bent_edges.hpp"
#include "robot_vision/tag_pose.hpp"
#include "robot_vision/tag_pose_tracker.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
{

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;
using CornersById = std::map<int, Matrix>;

std::vector<TagCorners> toTags(const CornersById& corners)
{
  std::vector<TagCorners> tags;
  for (const auto& [id, matrix] : corners)
  {
    if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 2)
      throw py::value_error("expected a (4, 2) array of the corners of tag " + std::to_string(id));
    TagCorners tag;
    tag.id = id;
    for (py::ssize_t i = 0; i < 4; ++i)
      tag.corners[static_cast<std::size_t>(i)] = {matrix.at(i, 0), matrix.at(i, 1)};
    tags.push_back(tag);
  }
  return tags;
}

cv::Affine3d toPose(const Matrix& matrix)
{
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4) throw py::value_error("expected a 4x4 pose");
  return cv::Affine3d(cv::Matx44d(matrix.data()));
}

py::array_t<double> toMatrix(const cv::Matx66d& matrix)
{
  return py::array_t<double>({6, 6}, matrix.val);
}

constexpr const char* kCorners =
    "corners: by id of the tag, (4, 2) px each, counter-clockwise for somebody who looks at the tag, from the bottom "
    "left one; of tags that are not in the bundle they are left out. None is returned if no tag is left, or no pose in "
    "front of the camera is like it.\n\nRaises ValueError for corners that are no tag's.";

void bindBundle(py::module& m)
{
  py::class_<BundleTag>(m, "BundleTag", "A tag on a rigid body: id, size (m) and 4x4 pose in the body's frame (m).")
      .def(py::init(
               [](int id, double size, const Matrix& pose) {
                 return BundleTag{id, size, toPose(pose)};
               }),
           "id"_a, "size"_a, "pose"_a)
      .def_readonly("id", &BundleTag::id)
      .def_readonly("size", &BundleTag::size, "m, outer edge of the black border")
      .def_property_readonly(
          "pose", [](const BundleTag& tag) { return toNumpy(tag.pose.matrix); },
          "4x4, m; of the tag's frame: x right, y up, z out of it as seen in front of it, the origin in its middle");

  py::class_<Bundle>(m, "Bundle", "Tags on one rigid body.")
      .def(py::init(
               [](const std::string& name, const std::vector<BundleTag>& tags)
               {
                 const Bundle bundle{name, tags};
                 validate(bundle);
                 return bundle;
               }),
           "name"_a, "tags"_a, "Raises ValueError naming what is wrong: no tags, an id twice, a size, a pose.")
      .def_readonly("name", &Bundle::name)
      .def_readonly("tags", &Bundle::tags);
  m.def(
      "single_tag",
      [](int id, double size)
      {
        const Bundle bundle = singleTag(id, size);
        validate(bundle);
        return bundle;
      },
      "id"_a, "size"_a, "A tag (size in m) as a Bundle.\n\nRaises ValueError as Bundle does.");
}

void bindResult(py::module& m)
{
  py::class_<PoseEstimate>(m, "PoseEstimate", "A pose of a body in the camera's optical frame.")
      .def_property_readonly(
          "pose", [](const PoseEstimate& e) { return toNumpy(e.pose.matrix); }, "4x4, m")
      .def_property_readonly(
          "covariance", [](const PoseEstimate& e) { return toMatrix(e.covariance); },
          "6x6, of x, y, z (m) and rotations about x, y, z (rad), all along the camera's axes")
      .def_readonly("error", &PoseEstimate::error, "px, root mean square distance of the corners");

  py::class_<TagPoses>(m, "TagPoses", "The two poses that corners agree with.")
      .def_readonly("best", &TagPoses::best)
      .def_readonly("other", &TagPoses::other, "None if there is none")
      .def_readonly("ratio", &TagPoses::ratio, "error of the best to that of the other, 0 if there is none")
      .def_readonly("probability", &TagPoses::probability, "that the best one is right, 0 to 1");
}

}  // namespace

/// Poses of tags.
void bindTagPoses(py::module& m)
{
  m.def(
      "without_bent_edges",
      [](const Matrix& corners, const CameraModel& camera)
      {
        const auto found = withoutBentEdges(toTags({{0, corners}}).front().corners, camera);
        return toNumpy(std::vector<cv::Point2d>(found.begin(), found.end()));
      },
      "corners"_a, "camera"_a,
      "Where the corners of a tag are, (4, 2) px, from those that a TagDetector finds: it fits straight lines to the "
      "edges, which the lens has bent.");
  bindBundle(m);
  bindResult(m);
  m.def(
      "estimate_pose",
      [](const Bundle& bundle, const CornersById& corners, const CameraModel& camera, double noise)
      { return estimatePose(bundle, toTags(corners), camera, noise); },
      "bundle"_a, "corners"_a, "camera"_a, "noise"_a = TagPoseParams().corner_noise,
      (std::string("The TagPoses of a Bundle in one picture.\n\nnoise: px, of each coordinate; ") + kCorners).c_str());

  py::class_<TagPoseParams>(
      m, "TagPoseParams",
      "Noise of the corners until it has been measured, the least part of it that lasts at rest (px), "
      "and s after which a body is new.")
      .def(py::init<>())
      .def_readwrite("corner_noise", &TagPoseParams::corner_noise)
      .def_readwrite("lasting_noise", &TagPoseParams::lasting_noise)
      .def_readwrite("max_gap", &TagPoseParams::max_gap);

  py::class_<TagPoseTracker>(m, "TagPoseTracker", "The pose of a Bundle over time.")
      .def(py::init<const Bundle&, const TagPoseParams&>(), "bundle"_a, "params"_a = TagPoseParams())
      .def(
          "update",
          [](TagPoseTracker& tracker, double time, const CornersById& corners, const CameraModel& camera)
          { return tracker.update(time, toTags(corners), camera); },
          "time"_a, "corners"_a, "camera"_a,
          (std::string("The TagPoses in the frame of a time, s.\n\n") + kCorners).c_str())
      .def_property_readonly("corner_noise", &TagPoseTracker::cornerNoise,
                             "px, standard deviation of each coordinate of a corner, as measured");
}
