#include "robot_vision/meshes/mesh_renderer.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_arrays.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace meshes_renderer_bindings
{

using Vector = std::array<double, 3>;

/// What is drawn, and how.
struct Drawing
{
  Drawing(const py::object& camera_of, const Box& region_of, const std::optional<std::array<double, 3>>& to_light,
          const RenderParts& wanted)
    : camera(toMeshCamera(camera_of)), region(toRect(region_of)), parts(wanted)
  {
    if (to_light) parts.to_light = cv::Vec3d((*to_light)[0], (*to_light)[1], (*to_light)[2]);
  }

  MeshCamera camera;
  cv::Rect region;
  RenderParts parts;
};

MeshView drawMeshes(const std::vector<const MeshRenderer*>& renderers, const std::vector<Matrix>& matrices,
                    const py::object& camera, const Box& region, bool bgr, bool normals, bool ids,
                    const std::optional<Vector>& to_light)
{
  if (renderers.size() != matrices.size() || renderers.empty())
    throw py::value_error("expected as many poses as renderers, and one at least");
  if (std::find(renderers.begin(), renderers.end(), nullptr) != renderers.end())
    throw py::value_error("expected renderers, not None");
  const Drawing drawing(camera, region, to_light, {bgr, normals, ids, {}});
  std::vector<cv::Affine3d> poses;
  for (const Matrix& matrix : matrices)
    poses.push_back(toPose(matrix));
  MeshView view;
  const LeaveGil unlocked;
  renderers[0]->render(drawing.camera, poses[0], drawing.region, view, drawing.parts);
  for (std::size_t i = 1; i < poses.size(); ++i)
    renderers[i]->merge(drawing.camera, poses[i], drawing.region, view, drawing.parts, static_cast<int>(i));
  return view;
}

/// None for an image that was not asked for.
template <cv::Mat MeshView::*image>
py::object partOf(const MeshView& view)
{
  return (view.*image).empty() ? py::object(py::none()) : py::object(toPython(view.*image));
}

void bindRenderer(py::module& m)
{
  py::class_<MeshCamera>(m, "MeshCamera", "The camera that meshes are drawn for, with tables for its lens.")
      .def(py::init(&toMeshCamera), "camera"_a,
           "camera: a CameraModel, or a 3x3 matrix K of a camera without distortion. Takes 0.1 us for each pixel of a "
           "camera with distortion: keep it.\n\nRaises ValueError for what no camera has.");

  py::class_<MeshView>(m, "MeshView", "Images of what a camera sees of meshes, (height, width) of the region.")
      .def_property_readonly("depth", &partOf<&MeshView::depth>,
                             "float32, z (m) of what the ray of each pixel meets first, NaN where nothing is")
      .def_property_readonly("bgr", &partOf<&MeshView::bgr>, "(height, width, 3) uint8, 0 where nothing is; or None")
      .def_property_readonly("normals", &partOf<&MeshView::normals>,
                             "(height, width, 3) float32, of length 1, in the camera's optical frame, towards the "
                             "camera, NaN where nothing is; or None")
      .def_property_readonly("ids", &partOf<&MeshView::ids>,
                             "uint16, 0 where nothing is, else 1 + the index of the mesh; or None");

  py::class_<MeshRenderer>(m, "MeshRenderer", "Draws a mesh. Threads may share one.")
      .def(py::init([](const Mesh& mesh) { return withoutGil([&] { return std::make_unique<MeshRenderer>(mesh); }); }),
           "mesh"_a)
      .def_property_readonly("extent", &MeshRenderer::extent, "the MeshExtent")
      .def(
          "render",
          [](const MeshRenderer& renderer, const py::object& camera, const Matrix& pose, const Box& region, bool bgr,
             bool normals, bool ids, const std::optional<Vector>& to_light)
          { return drawMeshes({&renderer}, {pose}, camera, region, bgr, normals, ids, to_light); },
          "camera"_a, "pose"_a, "region"_a, "bgr"_a = false, "normals"_a = false, "ids"_a = false,
          "to_light"_a = py::none(),
          "A MeshView. camera: a MeshCamera, a 3x3 matrix K, or a CameraModel; pose: 4x4, mesh in the camera's optical "
          "frame, m; region: x, y, width and height, px; bgr, normals, ids: whether these are drawn, too; to_light: "
          "direction to a far lamp in the optical frame, None: it is at the camera.\n\n"
          "Raises ValueError for what is not finite or too large.");
  m.def("render_meshes", &drawMeshes, "renderers"_a, "poses"_a, "camera"_a, "region"_a, "bgr"_a = false,
        "normals"_a = false, "ids"_a = false, "to_light"_a = py::none(),
        "A MeshView of several meshes, of which the nearest are seen, as render() of a MeshRenderer does it.");
}

const Bindings kBindings("meshes/renderer", {"geometry", "meshes"}, bindRenderer);

}  // namespace meshes_renderer_bindings
