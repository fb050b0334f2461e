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
#include "robot_vision/recognition/object_recognizer.hpp"
#include "robot_vision/recognition/point_pairs.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace recognition_objects_bindings
{

PoseCandidate makeCandidate(int model, const Matrix& pose, double score, const Box& box, int view)
{
  return {model, toPose(pose), score, toRect(box), view};
}

void bindCandidates(py::module& m)
{
  py::class_<PoseCandidate>(m, "PoseCandidate", "Where an object may be: near enough to be refined, but not verified.")
      .def(py::init(&makeCandidate), "model"_a, "pose"_a, "score"_a = 0.0, "box"_a = Box(0, 0, 0, 0), "view"_a = 0)
      .def_readonly("model", &PoseCandidate::model, "index of the model")
      .def_property_readonly("pose", attribute(&PoseCandidate::pose),
                             "4x4, m, of the mesh's frame in the camera's optical frame")
      .def_readonly("score", &PoseCandidate::score, "0 to 1")
      .def_property_readonly("box", attribute(&PoseCandidate::box), "(x, y, width, height), px")
      .def_readonly("view", &PoseCandidate::view, "index of the view that looks most alike");
}

void bindResults(py::module& m)
{
  py::class_<RecognizedObject>(m, "RecognizedObject", "An object that is there.")
      .def_readonly("model", &RecognizedObject::model, "index, in the order in which the models were added")
      .def_property_readonly("pose", attribute(&RecognizedObject::pose),
                             "4x4, m, of the mesh's frame in the camera's optical frame")
      .def_property_readonly("covariance", attribute(&RecognizedObject::covariance),
                             "6x6, of x, y, z (m) and the rotations about x, y, z (rad) along the camera's axes")
      .def_property_readonly(
          "free_axes", [](const RecognizedObject& object) { return axesToPython(object.free_axes); },
          "list of (point, direction) in the mesh's frame: lines about which it could be turned by any angle")
      .def_readonly("probability", &RecognizedObject::probability, "0 to 1")
      .def_readonly("occlusion", &RecognizedObject::occlusion, "0 to 1, share of the object that is hidden")
      .def_readonly("match_score", &RecognizedObject::match_score, "of its candidate")
      .def_property_readonly("box", attribute(&RecognizedObject::box), "(x, y, width, height), px, around it")
      .def_readonly("evidence", &RecognizedObject::evidence);
  py::class_<ModelReport>(m, "ModelReport", "What became of the candidates of a model.")
      .def_readonly("model", &ModelReport::model, "its index")
      .def_readonly("candidates", &ModelReport::candidates, "that came")
      .def_readonly("refined", &ModelReport::refined, "of them that were refined and verified")
      .def_readonly("found", &ModelReport::found, "objects")
      .def_readonly("best_probability", &ModelReport::best_probability, "of all that were verified")
      .def_readonly("best_score", &ModelReport::best_score, "of the candidates")
      .def_readonly("nearest_distance", &ModelReport::nearest_distance,
                    "m, of the candidates' middles; 0: there is none")
      .def_property_readonly("reason", &reasonText, "why nothing was found, as a line; or found");
  py::class_<Recognition>(m, "Recognition", "The objects in a frame, and what became of each model.")
      .def_readonly("objects", &Recognition::objects, "the most probable first")
      .def_readonly("reports", &Recognition::reports, "of each model, in their order");
}

void bindRecognizer(py::module& m)
{
  bindParams<RecognizerParams>(m, "RecognizerParams", "How an ObjectRecognizer decides.");
  py::class_<ObjectRecognizer>(m, "ObjectRecognizer",
                               "Tells which of the candidates of a matcher are objects, and where exactly. For one "
                               "thread at a time.")
      .def(py::init<const RecognizerParams&, const RefinerParams&, const VerifierParams&, const DepthErrorParams&>(),
           "params"_a = RecognizerParams(), "refiner"_a = RefinerParams(), "verifier"_a = VerifierParams(),
           "errors"_a = DepthErrorParams(), "Raises ValueError for a parameter out of range.")
      .def(
          "add",
          [](ObjectRecognizer& recognizer, std::shared_ptr<ObjectShape> shape)
          { return recognizer.add(std::move(shape)); },
          "shape"_a, "Adds a model, and returns its index: 0, 1, ...")
      .def(
          "recognize",
          [](ObjectRecognizer& recognizer, const ArrayFrame& frame, const std::vector<PoseCandidate>& candidates)
          { return withoutGil([&] { return recognizer.recognize(frame, candidates); }); },
          "frame"_a, "candidates"_a,
          "The Recognition of a frame, from PoseCandidates.\n\nRaises ValueError if nothing was set in the frame, and "
          "for a candidate of no model.");
}

/// A copy of the bytes of an object.
std::vector<std::uint8_t> toByteVector(const py::bytes& bytes)
{
  const std::string text = bytes;
  return {text.begin(), text.end()};
}

void bindPointPairs(py::module& m)
{
  bindParams<PointPairParams>(m, "PointPairParams", "How train_point_pairs() samples a surface.");
  bindParams<PointPairMatchParams>(m, "PointPairMatchParams", "How a PointPairMatcher looks for objects.");
  py::class_<PointPairModel>(
      m, "PointPairModel",
      "Points all over the surface of an object, whose pairs a PointPairMatcher knows it by. Threads may share one.")
      .def_readonly("params", &PointPairModel::params)
      .def_readonly("extent", &PointPairModel::extent)
      .def_property_readonly(
          "points", [](const PointPairModel& model) { return rowsToPython(model.points); }, "(n, 3) float32, m")
      .def_property_readonly(
          "normals", [](const PointPairModel& model) { return rowsToPython(model.normals); },
          "(n, 3) float32, of length 1")
      .def(
          "to_bytes",
          [](const PointPairModel& model)
          {
            const std::vector<std::uint8_t> bytes = toBytes(model);
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          "The model as bytes that are the same on all machines.")
      .def_static(
          "from_bytes",
          [](const py::bytes& bytes)
          {
            const std::vector<std::uint8_t> copy = toByteVector(bytes);
            return withoutGil([&] { return pointPairModelFromBytes(copy.data(), copy.size()); });
          },
          "bytes"_a, "The inverse. Raises ValueError for bytes that are no such model.");
  m.attr("POINT_PAIR_METHOD") = PointPairModel::kMethod;
  m.def("train_point_pairs", &trainPointPairs, "mesh"_a, "params"_a = PointPairParams(), Unlocked(),
        "A PointPairModel of a mesh, the same each time. Raises ValueError for what no mesh can have, and a parameter "
        "out of range.");
  py::class_<PointPairMatcher>(m, "PointPairMatcher",
                               "Finds where objects may be in the depths of frames, by features of point pairs. For "
                               "one thread at a time.")
      .def(py::init<const PointPairMatchParams&>(), "params"_a = PointPairMatchParams(),
           "Raises ValueError for a parameter out of range.")
      .def("add", &PointPairMatcher::add, "model"_a, Unlocked(), "Adds a model, and returns its index: 0, 1, ...")
      .def(
          "match",
          [](PointPairMatcher& matcher, const ArrayFrame& frame)
          { return withoutGil([&] { return matcher.match(frame); }); },
          "frame"_a,
          "A list of PoseCandidates for all models, those of each the best first; empty without depths.\n\nRaises "
          "ValueError if nothing was set in the frame.");
}

void bindObjects(py::module& m)
{
  bindCandidates(m);
  bindResults(m);
  bindRecognizer(m);
  bindPointPairs(m);
}

const Bindings kBindings("recognition_objects", {"recognition_poses", "meshes"}, bindObjects);

}  // namespace recognition_objects_bindings
