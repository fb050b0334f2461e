#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "recognition_arrays.hpp"
#include "registry.hpp"
#include "robot_vision/recognition/object_matcher.hpp"
#include "robot_vision/recognition/view_trainer.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace recognition_views_bindings
{

std::unique_ptr<ViewTrainer> makeTrainer(const Mesh& mesh, const ViewParams& params, const Symmetries& symmetries)
{
  const std::vector<Symmetry> known = toSymmetries(symmetries);
  return withoutGil([&] { return std::make_unique<ViewTrainer>(mesh, params, known); });
}

py::bytes bytesOf(const ViewModel& model)
{
  const std::vector<std::uint8_t> bytes = withoutGil([&] { return toBytes(model); });
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ViewModel modelOf(const py::bytes& bytes)
{
  const std::string text = bytes;
  return withoutGil([&]
                    { return viewModelFromBytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()); });
}

void bindModels(py::module& m)
{
  bindParams<ViewParams>(m, "ViewParams", "How a ViewTrainer learns an object.");
  py::class_<ViewModel>(m, "ViewModel",
                        "An object as its views, for an ObjectMatcher. Made by a ViewTrainer. Threads may share one.")
      .def_readonly("params", &ViewModel::params)
      .def_property_readonly(
          "views", [](const ViewModel& model) { return model.views.size(); }, "how many views it has")
      .def_property_readonly(
          "all_views", [](const ViewModel& model) { return model.levels.empty() ? 0 : model.levels.back(); },
          "how many it has when training has ended")
      .def_property_readonly("templates", &ViewModel::templates, "its views with all their turns")
      .def_property_readonly("memory", &ViewModel::memory, "bytes that it takes")
      .def("to_bytes", &bytesOf, "The model as bytes that are the same on all machines.")
      .def_static("from_bytes", &modelOf, "bytes"_a,
                  "The inverse. Raises ValueError for bytes that are no such model.");
}

void bindTrainer(py::module& m)
{
  py::class_<ViewTrainer>(m, "ViewTrainer", "Learns what an object looks like from its mesh. Threads may share one.")
      .def(py::init(&makeTrainer), "mesh"_a, "params"_a = ViewParams(), "symmetries"_a = Symmetries(),
           "mesh: a Mesh; symmetries: list of (axis, fold), turns about an axis through the center of its extent by "
           "multiples of 360 / fold degrees, or with a fold of 0 by any angle, that show the same.\n\n"
           "Raises ValueError for what no mesh and no symmetries can have, and a parameter out of range.")
      .def(
          "untrained", [](const ViewTrainer& trainer) { return trainer.untrained(); }, "A model that has no view yet.")
      .def(
          "train",
          [](const ViewTrainer& trainer, ViewModel& model, int threads, const ViewTrainer::Progress& progress)
          { trainer.train(model, threads, progress); },
          "model"_a, "threads"_a = 1, "progress"_a = ViewTrainer::Progress(), Unlocked(),
          "Adds views to a model until it has all, or progress(done, all) returns False, which is called after some "
          "views.\n\nRaises ValueError if the model is not one of this mesh, parameters and symmetries.");
}

void bindMatcher(py::module& m)
{
  bindParams<ObjectMatchParams>(m, "ObjectMatchParams", "How an ObjectMatcher looks for objects.");
  py::class_<ObjectMatcher>(m, "ObjectMatcher",
                            "Looks for objects, of which it has models, in the frames of a camera. For one thread at a "
                            "time.")
      .def(py::init<const ObjectMatchParams&>(), "params"_a = ObjectMatchParams())
      .def("configure", &ObjectMatcher::configure, "params"_a)
      .def("add", &ObjectMatcher::add, "model"_a, Unlocked(), "Adds a ViewModel, and returns its index: 0, 1, ...")
      .def(
          "match",
          [](ObjectMatcher& matcher, const py::array& image, const std::optional<py::array>& depth,
             const CameraModel& camera, const std::optional<py::array>& mask)
          {
            const ImageArray colors(image);
            std::optional<DepthArray> depths;
            std::optional<ImageArray> only;
            if (depth) depths.emplace(*depth);
            if (mask) only.emplace(*mask);
            return withoutGil(
                [&]
                {
                  return matcher.match(colors.view, depths ? depths->view : cv::Mat(),
                                       depths ? depths->encoding : "32FC1", camera, only ? only->view : cv::Mat());
                });
          },
          "image"_a, "depth"_a, "camera"_a, "mask"_a = py::none(),
          "A list of PoseCandidates. image: (height, width[, 3]) uint8; depth: (height, width) uint16 in mm or float32 "
          "in m, or None; mask: uint8, not 0 where objects may be.\n\nRaises ValueError for images of other sizes.");
}

void bindViews(py::module& m)
{
  bindModels(m);
  bindTrainer(m);
  bindMatcher(m);
}

const Bindings kBindings("recognition_views", {"recognition_objects", "meshes"}, bindViews);

}  // namespace recognition_views_bindings
