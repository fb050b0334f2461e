#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <variant>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/tags/pose/corner_refinement.hpp"
#include "robot_vision/tags/pose/corner_undistortion.hpp"
#include "robot_vision/tags/pose/tag_pose.hpp"
#include "robot_vision/tags/pose/tag_pose_tracker.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace tags_pose_bindings
{

using CornersById = std::map<int, std::variant<TagCorners, Matrix>>;

TagCorners toTag(int id, const Matrix& matrix)
{
  TagCorners tag;
  tag.id = id;
  tag.corners = toCorners(matrix, "tag " + std::to_string(id));
  return tag;
}

std::vector<TagCorners> toTags(const CornersById& corners)
{
  std::vector<TagCorners> tags;
  for (const auto& [id, found] : corners)
  {
    const auto* measured = std::get_if<TagCorners>(&found);
    tags.push_back(measured ? *measured : toTag(id, std::get<Matrix>(found)));
    tags.back().id = id;
  }
  return tags;
}

constexpr const char* kCorners =
    "corners: by id of the tag, MeasuredCorners or (4, 2) px each, counter-clockwise for somebody who looks at the "
    "tag, from the bottom left one; of tags that are not in the bundle they are left out. None is returned if no tag "
    "is left, or no pose in front of the camera is like it.\n\nRaises ValueError for corners that are no tag's.";

Bundle validated(const Bundle& bundle)
{
  validate(bundle);
  return bundle;
}

void bindBundle(py::module& m)
{
  py::class_<BundleTag>(m, "BundleTag", "A tag on a rigid body: id, size (m) and 4x4 pose in the body's frame (m).")
      .def(py::init(
               [](int id, double size, const Matrix& pose, double shift_noise, double turn_noise) {
                 return BundleTag{id, size, toPose(pose), shift_noise, turn_noise};
               }),
           "id"_a, "size"_a, "pose"_a, "shift_noise"_a = 0.0, "turn_noise"_a = 0.0)
      .def_readonly("id", &BundleTag::id)
      .def_readonly("size", &BundleTag::size, "m, outer edge of the black border")
      .def_readonly("shift_noise", &BundleTag::shift_noise, "m, standard deviation of each coordinate of its place")
      .def_readonly("turn_noise", &BundleTag::turn_noise, "rad, standard deviation of its rotation about each axis")
      .def_property_readonly(
          "pose", attribute(&BundleTag::pose),
          "4x4, m; of the tag's frame: x right, y up, z out of it as seen in front of it, the origin in its middle");

  py::class_<Bundle>(m, "Bundle", "Tags on one rigid body.")
      .def(py::init(
               [](const std::string& name, const std::vector<BundleTag>& tags) {
                 return validated({name, tags});
               }),
           "name"_a, "tags"_a, "Raises ValueError naming what is wrong: no tags, an id twice, a size, a pose.")
      .def_readonly("name", &Bundle::name)
      .def_readonly("tags", &Bundle::tags);
  m.def(
      "single_tag", [](int id, double size) { return validated(singleTag(id, size)); }, "id"_a, "size"_a,
      "A tag (size in m) as a Bundle.\n\nRaises ValueError as Bundle does.");
}

void bindResult(py::module& m)
{
  py::class_<PoseEstimate>(m, "PoseEstimate", "A pose of a body in the camera's optical frame.")
      .def_property_readonly("pose", attribute(&PoseEstimate::pose), "4x4, m")
      .def_property_readonly("covariance", attribute(&PoseEstimate::covariance),
                             "6x6, of x, y, z (m) and rotations about x, y, z (rad), all along the camera's axes")
      .def_readonly("error", &PoseEstimate::error, "px, root mean square distance of the corners");

  py::class_<TagPoses>(m, "TagPoses", "The two poses that corners agree with.")
      .def_readonly("best", &TagPoses::best)
      .def_readonly("other", &TagPoses::other, "None if there is none")
      .def_readonly("ratio", &TagPoses::ratio, "error of the best to that of the other, 0 if there is none")
      .def_readonly("probability", &TagPoses::probability, "that the best one is right, 0 to 1")
      .def_readonly("planes", &TagPoses::planes, "number of tags whose planes in a depth image it explains, too");
}

TagCorners makeCorners(const Matrix& corners, const std::optional<Matrix>& covariance,
                       const std::optional<DepthPlane>& plane)
{
  TagCorners tag = toTag(0, corners);
  tag.plane = plane;
  if (!covariance) return tag;
  if (covariance->ndim() != 2 || covariance->shape(0) != 8 || covariance->shape(1) != 8)
    throw py::value_error("expected an (8, 8) covariance");
  tag.covariance = CornerCovariance(covariance->data());
  return tag;
}

void bindCorners(py::module& m)
{
  py::class_<TagCorners>(m, "MeasuredCorners", "Where the corners of a tag are, and how well that is known.")
      .def(py::init(&makeCorners), "corners"_a, "covariance"_a = py::none(), "plane"_a = py::none(),
           "plane: the tag's DepthPlane in a depth image of the same time, as measure_tag_plane() finds it.")
      .def_property_readonly("corners", attribute(&TagCorners::corners), "(4, 2) px")
      .def_property_readonly(
          "covariance",
          [](const TagCorners& tag) -> py::object
          {
            if (!tag.covariance) return py::none();
            return toPython(*tag.covariance);
          },
          "8x8 px^2, of x and y of the first corner to x and y of the last one; None if it was not measured")
      .def_readonly("plane", &TagCorners::plane, "DepthPlane, or None");
  m.def(
      "measure_corners",
      [](const py::array& gray, const py::array& cells, int width_at_border, const Matrix& near,
         const CameraModel& camera)
      {
        const ImageArray image(gray), pattern(cells);
        const TagCorners start = toTag(0, near);
        const LeaveGil unlocked;
        return measureCorners(image.view, pattern.view, width_at_border, start, camera);
      },
      "gray"_a, "cells"_a, "width_at_border"_a, "near"_a, "camera"_a,
      "The MeasuredCorners of a tag near where they were found, (4, 2) px, or None where the gray image does not "
      "look like it; see corner_refinement.hpp.\n\ncells: of tag_cells(); width_at_border: of its TagFamily.");
}

void bindTagPoses(py::module& m)
{
  bindCorners(m);
  m.def(
      "without_bent_edges",
      [](const Matrix& corners, const CameraModel& camera)
      {
        const TagCorners found = toTag(0, corners);
        return toPython(withoutGil([&] { return withoutBentEdges(found.corners, camera); }));
      },
      "corners"_a, "camera"_a,
      "Where the corners of a tag are, (4, 2) px, from those that a TagDetector finds: it fits straight lines to the "
      "edges, which the lens has bent.");
  bindBundle(m);
  bindResult(m);
  m.def(
      "estimate_pose",
      [](const Bundle& bundle, const CornersById& corners, const CameraModel& camera, double noise, double lens_noise)
      {
        const std::vector<TagCorners> seen = toTags(corners);
        const LeaveGil unlocked;
        return estimatePose(bundle, seen, camera, noise, lens_noise);
      },
      "bundle"_a, "corners"_a, "camera"_a, "noise"_a = TagPoseParams().corner_noise,
      "lens_noise"_a = TagPoseParams().lasting_noise,
      (std::string("The TagPoses of a Bundle in one image.\n\nnoise: px, of each coordinate where it was not "
                   "measured; lens_noise: px, what the calibration leaves of the lens; ") +
       kCorners)
          .c_str());

  bindParams<TagPoseParams>(m, "TagPoseParams",
                            "What a TagPoseTracker knows of the noise of corners, and how long it waits for tags.");

  py::class_<TagPoseTracker>(m, "TagPoseTracker", "The pose of a Bundle over time. Not for two threads at once.")
      .def(py::init<const Bundle&, const TagPoseParams&>(), "bundle"_a, "params"_a = TagPoseParams())
      .def(
          "update",
          [](TagPoseTracker& tracker, double time, const CornersById& corners, const CameraModel& camera)
          {
            const std::vector<TagCorners> seen = toTags(corners);
            const LeaveGil unlocked;
            return tracker.update(time, seen, camera);
          },
          "time"_a, "corners"_a, "camera"_a,
          (std::string("The TagPoses in the frame of a time, s.\n\n") + kCorners).c_str())
      .def_property_readonly("corner_noise", &TagPoseTracker::cornerNoise,
                             "px, standard deviation of each coordinate of a corner in the newest frame: of a bundle "
                             "the corners of its tag that was seen with the least id");
}

const Bindings kBindings("tags/pose", {"geometry", "tags/plane"}, bindTagPoses);

}  // namespace tags_pose_bindings
