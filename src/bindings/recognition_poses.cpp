#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "recognition_arrays.hpp"
#include "registry.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/pose_refiner.hpp"
#include "robot_vision/recognition/pose_verifier.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace recognition_poses_bindings
{

std::shared_ptr<ObjectShape> makeShape(const Mesh& mesh, const Symmetries& symmetries)
{
  const std::vector<Symmetry> known = toSymmetries(symmetries);
  return withoutGil([&] { return std::make_shared<ObjectShape>(mesh, known); });
}

std::vector<py::array> turnsToPython(const SymmetryGroup& group)
{
  std::vector<py::array> turns;
  for (const cv::Matx33d& turn : group.turns())
    turns.push_back(toPython(turn));
  return turns;
}

void bindSymmetries(py::module& m)
{
  py::class_<SymmetryGroup>(m, "SymmetryGroup", "All turns of an object that its symmetries make together.")
      .def(py::init([](const Symmetries& symmetries) { return SymmetryGroup(toSymmetries(symmetries)); }),
           "symmetries"_a,
           "symmetries: list of (axis, fold), as those of an ObjectShape.\n\n"
           "Raises ValueError for an axis or a fold that cannot be, more than 20 symmetries, and such that do not "
           "belong to one object.")
      .def_property_readonly("turns", &turnsToPython,
                             "list of 3x3, the one by nothing first; of those by any angle about an axis one for each "
                             "way that they leave it");
}

void bindShapes(py::module& m)
{
  py::class_<ObjectShape, std::shared_ptr<ObjectShape>>(
      m, "ObjectShape", "What refining and verifying poses needs to know of an object. Threads may share one.")
      .def(py::init(&makeShape), "mesh"_a, "symmetries"_a = Symmetries(),
           "mesh: a Mesh; symmetries: list of (axis, fold), turns about an axis through the center of its extent by "
           "multiples of 360 / fold degrees, or with a fold of 0 by any angle, that show the same.\n\n"
           "Raises ValueError for what no mesh and no symmetries can have.")
      .def_property_readonly("extent", &ObjectShape::extent, "the MeshExtent")
      .def_property_readonly("renderer", &ObjectShape::renderer, "the MeshRenderer that draws it")
      .def_property_readonly("has_colors", &ObjectShape::hasColors, "whether its colors tell it from others");
}

void bindFrames(py::module& m)
{
  py::class_<ArrayFrame>(m, "RecognitionFrame",
                         "What a camera without distortion sees at one time, prepared for all who look for objects in "
                         "it. Threads may share one, but not while one of them is in set().")
      .def(py::init<const CameraModel&>(), "camera"_a,
           "Raises ValueError for what no camera has, and for one with distortion: images must have been rectified.")
      .def(
          "set", &ArrayFrame::setArrays, "bgr"_a = py::none(), "depth"_a = py::none(),
          "Takes the images of a frame: bgr, (height, width, 3) uint8 or None, and depth, (height, width) uint16 in mm "
          "or float32 in m or None.\n\n"
          "Raises ValueError for images that are not of the camera's size, and if both are None.");
}

void bindRefiner(py::module& m)
{
  bindParams<RefinerParams>(m, "RefinerParams", "How a PoseRefiner finds poses.");
  py::class_<RefinedPose>(m, "RefinedPose", "A pose that fits to a frame.")
      .def_property_readonly("pose", attribute(&RefinedPose::pose),
                             "4x4, m, of the mesh's frame in the camera's optical frame")
      .def_property_readonly("covariance", attribute(&RefinedPose::covariance),
                             "6x6, of x, y, z (m) and the rotations about x, y, z (rad) along the camera's axes")
      .def_property_readonly(
          "free_axes", [](const RefinedPose& refined) { return axesToPython(refined.free_axes); },
          "list of (point, direction) in the mesh's frame: lines about which it could be turned by any angle")
      .def_readonly("score", &RefinedPose::score, "0 to 1, how well the frame has what is expected there")
      .def_readonly("first_score", &RefinedPose::first_score, "of the first pose");
  py::class_<PoseRefiner>(m, "PoseRefiner",
                          "Finds the pose near a first one in which an object fits best to a frame. For one thread at "
                          "a time.")
      .def(py::init<const RefinerParams&, const DepthErrorParams&>(), "params"_a = RefinerParams(),
           "errors"_a = DepthErrorParams(), "Raises ValueError for a parameter out of range.")
      .def(
          "refine",
          [](PoseRefiner& refiner, const ArrayFrame& frame, const ObjectShape& shape, const Matrix& pose)
          {
            const cv::Affine3d first = toPose(pose);
            return withoutGil([&] { return refiner.refine(frame, shape, first); });
          },
          "frame"_a, "shape"_a, "pose"_a,
          "The RefinedPose near a 4x4 pose (m). Raises ValueError if that is not of a rigid body, and if nothing was "
          "set in the frame.");
}

void bindVerifier(py::module& m)
{
  bindParams<VerifierParams>(m, "VerifierParams", "How a PoseVerifier compares.");
  py::class_<PoseEvidence>(m, "PoseEvidence",
                           "What a frame says for and against an object in a pose; NaN where nothing tells it.")
      .def_readonly("agreeing", &PoseEvidence::agreeing, "share of its pixels with the depth of its surface")
      .def_readonly("pierced", &PoseEvidence::pierced, "share where something behind its surface is seen")
      .def_readonly("hidden", &PoseEvidence::hidden, "share where something before it is seen")
      .def_readonly("sunken", &PoseEvidence::sunken,
                    "share of the border of what agrees where what is seen goes straight on before the object")
      .def_readonly("unknown", &PoseEvidence::unknown, "share without a depth")
      .def_readonly("misfit", &PoseEvidence::misfit, "root mean square distance of what agrees, standard deviations")
      .def_readonly("noise", &PoseEvidence::noise, "what the misfit is if it is the sensor's noise alone")
      .def_readonly("normals", &PoseEvidence::normals, "share of what agrees that has the surface's normal")
      .def_readonly("outline", &PoseEvidence::outline, "share of its outline where the frame changes")
      .def_readonly("inner", &PoseEvidence::inner, "the same of its creases and the edges of its texture")
      .def_readonly("colors", &PoseEvidence::colors, "share that has its color")
      .def_readonly("pattern", &PoseEvidence::pattern, "correlation of its brightness, -1 to 1")
      .def_readonly("pixels", &PoseEvidence::pixels, "px^2 that agree; without depths, that it covers")
      .def_property_readonly("features", &evidenceFeatures, "what the probability follows from, in a fixed order");
  py::class_<PoseVerdict>(m, "PoseVerdict", "How probable a pose is after comparison.")
      .def_readonly("probability", &PoseVerdict::probability, "0 to 1, that the object is there in this pose")
      .def_readonly("occlusion", &PoseVerdict::occlusion, "0 to 1, share of the object that is hidden")
      .def_readonly("evidence", &PoseVerdict::evidence)
      .def_property_readonly("box", attribute(&PoseVerdict::box), "(x, y, width, height), px")
      .def_readonly("step", &PoseVerdict::step, "px between the pixels of the box that were compared")
      .def_property_readonly(
          "explained", [](const PoseVerdict& verdict) { return toPython(verdict.explained); },
          "uint8, of the compared pixels: 255 where the object is what is seen");
  py::class_<PoseVerifier>(m, "PoseVerifier",
                           "Draws an object in a pose and compares it with a frame. For one thread at a time.")
      .def(py::init<const VerifierParams&, const DepthErrorParams&>(), "params"_a = VerifierParams(),
           "errors"_a = DepthErrorParams(), "Raises ValueError for a parameter out of range.")
      .def(
          "verify",
          [](PoseVerifier& verifier, const ArrayFrame& frame, const ObjectShape& shape, const Matrix& matrix)
          {
            const cv::Affine3d pose = toPose(matrix);
            return withoutGil([&] { return verifier.verify(frame, shape, pose); });
          },
          "frame"_a, "shape"_a, "pose"_a,
          "The PoseVerdict of a 4x4 pose (m). Raises ValueError if that is not of a rigid body, and if nothing was set "
          "in the frame.");
}

void bindPoses(py::module& m)
{
  bindSymmetries(m);
  bindShapes(m);
  bindFrames(m);
  bindRefiner(m);
  bindVerifier(m);
}

const Bindings kBindings("recognition_poses", {"geometry", "depth", "meshes"}, bindPoses);

}  // namespace recognition_poses_bindings
