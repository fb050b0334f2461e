#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "depth_arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/recognition/texture_matcher.hpp"
#include "robot_vision/recognition/texture_model.hpp"
#include "robot_vision/recognition/texture_trainer.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace recognition_textures_bindings
{

py::bytes toPythonBytes(const TextureModel& model)
{
  const std::vector<std::uint8_t> bytes = withoutGil([&] { return toBytes(model); });
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TextureModel modelFromPython(const py::bytes& bytes)
{
  char* data = nullptr;
  py::ssize_t size = 0;
  if (PyBytes_AsStringAndSize(bytes.ptr(), &data, &size) != 0) throw py::error_already_set();
  const LeaveGil unlocked;
  return textureModelFromBytes(reinterpret_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size));
}

py::array_t<float> positionsOf(const TextureModel& model)
{
  py::array_t<float> positions({static_cast<py::ssize_t>(model.points.size()), py::ssize_t{3}});
  auto rows = positions.mutable_unchecked<2>();
  for (std::size_t i = 0; i < model.points.size(); ++i)
    for (int j = 0; j < 3; ++j)
      rows(static_cast<py::ssize_t>(i), j) = model.points[i].position[j];
  return positions;
}

void bindModel(py::module& m)
{
  bindParams<TextureParams>(m, "TextureParams", "How the texture of an object is learned.");

  py::class_<TextureModel>(m, "TextureModel", "An object as its keypoints. Threads may share one.")
      .def_static("from_bytes", &modelFromPython, "data"_a,
                  "What to_bytes() has written. Raises ValueError for what is damaged or of something else.")
      .def("to_bytes", &toPythonBytes, "The model as bytes that are the same on all machines.")
      .def_readonly("params", &TextureModel::params)
      .def_readonly("extent", &TextureModel::extent, "the MeshExtent of the object")
      .def_readonly("views", &TextureModel::views, "how many were learned")
      .def("__len__", [](const TextureModel& model) { return model.points.size(); })
      .def_property_readonly("positions", &positionsOf, "(n, 3) float32, m, of the keypoints in the object's frame");
}

MeshExtent extentOf(const std::array<double, 3>& center, const std::array<double, 3>& size)
{
  MeshExtent extent;
  for (int i = 0; i < 3; ++i)
  {
    extent.center[i] = center[static_cast<std::size_t>(i)];
    extent.size[i] = size[static_cast<std::size_t>(i)];
  }
  extent.diameter = cv::norm(extent.size);
  extent.radius = 0.5 * extent.diameter;
  return extent;
}

void addView(TextureTrainer& trainer, const py::array& image, const py::array& depth, const py::object& mask,
             const CameraModel& camera, const Matrix& pose)
{
  const ImageArray pixels(image);
  const DepthArray depths(depth);
  std::optional<ImageArray> own;
  if (!mask.is_none()) own.emplace(mask);
  TextureView view{pixels.view, cv::Mat(), own ? own->view : cv::Mat(), camera, toPose(pose)};
  const LeaveGil unlocked;
  toMetres(depths.view, depths.encoding, view.depth);
  trainer.add(view);
}

void bindTrainer(py::module& m)
{
  py::class_<TextureViews>(m, "TextureViews", "The views that a mesh is learned from, from all sides.")
      .def(py::init([](const Mesh& mesh, const TextureParams& params)
                    { return withoutGil([&] { return std::make_unique<TextureViews>(mesh, params); }); }),
           "mesh"_a, "params"_a = TextureParams())
      .def("__len__", &TextureViews::count)
      .def_property_readonly("extent", &TextureViews::extent, "the MeshExtent");

  py::class_<TextureTrainer>(m, "TextureTrainer", "Learns the keypoints of an object. Not for two threads at once.")
      .def(py::init(
               [](const TextureParams& params, const std::array<double, 3>& center, const std::array<double, 3>& size)
               { return std::make_unique<TextureTrainer>(params, extentOf(center, size)); }),
           "params"_a, "center"_a, "size"_a,
           "center, size: m, of the box along the axes of its frame that the object is in")
      .def(py::init<const TextureModel&>(), "state"_a, "Goes on with what another one had learned.")
      .def_readonly_static("MIN_POINTS", &TextureTrainer::kMinPoints, "fewest keypoints of an object")
      .def_property_readonly("views", &TextureTrainer::views, "how many were learned")
      .def("add", &addView, "image"_a, "depth"_a, "mask"_a, "camera"_a, "pose"_a,
           "Learns a view. image: BGR or gray; depth: uint16 in mm or float32 in m, of its pixels; mask: uint8, not 0 "
           "where the object is, None: wherever there is a depth; pose: 4x4, of the object in the camera's optical "
           "frame, m.\n\nRaises ValueError naming what is wrong.")
      .def(
          "add_of",
          [](TextureTrainer& trainer, const TextureViews& views, int index) { trainer.add(views.view(index)); },
          "views"_a, "index"_a, Unlocked(), "Learns a view of a mesh.")
      .def("state", &TextureTrainer::state, "All that was learned so far, a TextureModel.")
      .def("model", &TextureTrainer::model, Unlocked(),
           "The TextureModel to find the object by. Raises ValueError if it has too little texture.");
}

std::vector<TexturedObject> matchArrays(TextureMatcher& matcher, const py::array& image, const py::object& depth,
                                        const CameraModel& camera, const py::object& mask)
{
  const ImageArray pixels(image);
  std::optional<ImageArray> own;
  std::optional<DepthArray> depths;
  if (!mask.is_none()) own.emplace(mask);
  if (!depth.is_none()) depths.emplace(depth);
  const LeaveGil unlocked;
  return matcher.match(pixels.view, depths ? depths->view : cv::Mat(), depths ? depths->encoding : "32FC1", camera,
                       own ? own->view : cv::Mat());
}

void bindMatcher(py::module& m)
{
  bindParams<TextureMatchParams>(m, "TextureMatchParams", "How objects are found by their texture.");

  py::class_<TexturedObject>(m, "TexturedObject", "An object whose texture is seen.")
      .def_property_readonly(
          "model", [](const TexturedObject& o) { return o.candidate.model; }, "index of the model")
      .def_property_readonly(
          "pose", [](const TexturedObject& o) { return toPython(o.candidate.pose); },
          "4x4, object in the camera's optical frame, m")
      .def_property_readonly(
          "score", [](const TexturedObject& o) { return o.candidate.score; },
          "share of the keypoints within its outline that agree, 0 to 1")
      .def_property_readonly(
          "box", [](const TexturedObject& o) { return toPython(o.candidate.box); },
          "x, y, width and height, px; may reach out of the image")
      .def_property_readonly("covariance", attribute(&TexturedObject::covariance),
                             "6x6, of x, y, z (m) and the rotations about x, y, z (rad) along the camera's axes")
      .def_readonly("probability", &TexturedObject::probability, "0 to 1, that it is no coincidence")
      .def_readonly("matches", &TexturedObject::matches, "keypoints within its outline that look like its own")
      .def_readonly("inliers", &TexturedObject::inliers, "of them that are where they should be")
      .def_readonly("error", &TexturedObject::error, "px, root mean square distance of these from there")
      .def_readonly("depth_agreement", &TexturedObject::depth_agreement,
                    "share of them whose depth is that of the object; NaN: there is none");

  py::class_<TextureMatcher>(m, "TextureMatcher", "Finds objects by their texture. Not for two threads at once.")
      .def(py::init<const TextureMatchParams&, const DepthErrorParams&>(), "params"_a = TextureMatchParams(),
           "errors"_a = DepthErrorParams())
      .def("add", &TextureMatcher::add, "model"_a, Unlocked(), "Adds a TextureModel, and returns its index.")
      .def("match", &matchArrays, "image"_a, "depth"_a, "camera"_a, "mask"_a = py::none(),
           "list of TexturedObject. image: BGR or gray; depth: uint16 in mm or float32 in m, of its pixels, or None; "
           "mask: uint8, not 0 where keypoints count, or None: everywhere.\n\n"
           "Raises ValueError for images of another size than the camera's.");
}

void bindTextures(py::module& m)
{
  bindModel(m);
  bindTrainer(m);
  bindMatcher(m);
}

const Bindings kBindings("recognition_textures", {"geometry", "meshes", "depth"}, bindTextures);

}  // namespace recognition_textures_bindings
