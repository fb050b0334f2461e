#include "robot_vision/meshes/mesh.hpp"

#include <array>
#include <memory>
#include <utility>

#include "mesh_arrays.hpp"
#include "registry.hpp"
#include "robot_vision/meshes/mesh_reader.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace meshes_bindings
{

using Color = std::array<int, 3>;
using Vector = std::array<double, 3>;

Vector toVector(const cv::Vec3d& v)
{
  return {v[0], v[1], v[2]};
}

std::unique_ptr<Mesh> makeMesh(const py::object& vertices, const py::object& triangles, const py::object& normals,
                               const py::object& colors, const py::object& texture_coordinates,
                               const std::vector<py::array>& textures, const py::object& triangle_textures,
                               const Color& color)
{
  auto mesh = std::make_unique<Mesh>();
  mesh->vertices = toRows<float, 3>(vertices, "vertices");
  mesh->triangles = toRows<int, 3>(triangles, "triangles");
  mesh->normals = toRows<float, 3>(normals, "normals");
  mesh->colors = toRows<uchar, 3>(colors, "colors");
  mesh->texture_coordinates = toRows<float, 2>(texture_coordinates, "texture coordinates");
  for (const py::array& texture : textures)
    mesh->textures.push_back(ImageArray(texture).view.clone());
  if (!triangle_textures.is_none()) mesh->triangle_textures = triangle_textures.cast<std::vector<int>>();
  for (int i = 0; i < 3; ++i)
    mesh->color[i] = cv::saturate_cast<uchar>(color[static_cast<std::size_t>(i)]);
  validate(*mesh);
  return mesh;
}

std::vector<py::array> texturesOf(const Mesh& mesh)
{
  std::vector<py::array> textures;
  for (const cv::Mat& texture : mesh.textures)
    textures.push_back(toPython(texture));
  return textures;
}

void bindMesh(py::module& m)
{
  py::class_<Mesh>(m, "Mesh", "The surface of a thing, of triangles. Never changes.")
      .def(py::init(&makeMesh), "vertices"_a, "triangles"_a, "normals"_a = py::none(), "colors"_a = py::none(),
           "texture_coordinates"_a = py::none(), "textures"_a = std::vector<py::array>(),
           "triangle_textures"_a = py::none(), "color"_a = Color{160, 160, 160},
           "vertices: (n, 3), m; triangles: (t, 3), vertices, counter-clockwise for who sees the outside; normals: (n, "
           "3), of length 1; colors: (n, 3), BGR; texture_coordinates: (n, 2), 0 to 1 right and down from the top left "
           "corner; textures: BGR images; triangle_textures: (t,), the texture of each triangle, -1 for none; color: "
           "BGR of what has none of these.\n\nRaises ValueError for what no mesh can have.")
      .def_property_readonly(
          "vertices", [](const Mesh& mesh) { return rowsToPython(mesh.vertices); },
          "(n, 3) float32, m, in the mesh's own frame")
      .def_property_readonly(
          "triangles", [](const Mesh& mesh) { return rowsToPython(mesh.triangles); }, "(t, 3) int32, vertices")
      .def_property_readonly(
          "normals", [](const Mesh& mesh) { return rowsToPython(mesh.normals); },
          "(n, 3) float32, or (0, 3): each triangle is flat")
      .def_property_readonly(
          "colors", [](const Mesh& mesh) { return rowsToPython(mesh.colors); },
          "(n, 3) uint8, BGR, or (0, 3): all vertices have `color`")
      .def_property_readonly(
          "texture_coordinates", [](const Mesh& mesh) { return rowsToPython(mesh.texture_coordinates); },
          "(n, 2) float32, right and down from the top left corner, or (0, 2)")
      .def_property_readonly("textures", &texturesOf, "list of (height, width, 3) uint8, BGR")
      .def_property_readonly(
          "triangle_textures",
          [](const Mesh& mesh) {
            return py::array_t<int>(static_cast<py::ssize_t>(mesh.triangle_textures.size()),
                                    mesh.triangle_textures.data());
          },
          "(t,) int32, the texture of each triangle, -1 for none, or (0,)")
      .def_property_readonly(
          "color",
          [](const Mesh& mesh) {
            return Color{mesh.color[0], mesh.color[1], mesh.color[2]};
          },
          "BGR");

  py::class_<MeshExtent>(m, "MeshExtent", "Where the vertices of a mesh are.")
      .def_property_readonly(
          "center", [](const MeshExtent& e) { return toVector(e.center); },
          "m, the middle of the smallest box along the axes around them")
      .def_property_readonly(
          "size", [](const MeshExtent& e) { return toVector(e.size); }, "m, of that box")
      .def_readonly("diameter", &MeshExtent::diameter, "m, the largest distance of two vertices")
      .def_readonly("radius", &MeshExtent::radius, "m, the largest distance of a vertex from the center");
  m.def("mesh_extent", &meshExtent, "mesh"_a, py::call_guard<LeaveGil>(), "The extent of what triangles use.");
}

void bindReading(py::module& m)
{
  py::class_<LoadedMesh>(m, "LoadedMesh", "A mesh of a file, in m, and what there is to say of it.")
      .def_readonly("mesh", &LoadedMesh::mesh)
      .def_readonly("unit", &LoadedMesh::unit, "of the file: m, cm, mm or inch")
      .def_readonly("unit_reason", &LoadedMesh::unit_reason, "a sentence that says why it is taken for this one")
      .def_readonly("closed", &LoadedMesh::closed, "whether each edge has triangles on both sides")
      .def_readonly("open_edges", &LoadedMesh::open_edges, "how many have not")
      .def_readonly("dropped", &LoadedMesh::dropped, "how many triangles without an area were left out")
      .def_readonly("warnings", &LoadedMesh::warnings, "sentences: textures that are missing, what is not closed, ...");
  m.def(
      "read_mesh", &readMesh, "path"_a, "unit"_a = "", "scale"_a = 1.0, Unlocked(),
      "Reads a mesh, in a process of its own: stl, obj, dae, ply, gltf, glb, and what else assimp knows. unit: that of "
      "the file, m, cm, mm or inch; empty: what the file says, or what makes a thing that one can handle. scale: what "
      "its numbers are multiplied by besides.\n\n"
      "Raises ValueError naming the path for a file that is no mesh that can be used or another unit or scale, and "
      "RuntimeError if it cannot be read.");
}

void bindSamples(py::module& m)
{
  py::class_<SampleMesh>(m, "SampleMesh", "A mesh that is made by formulas.")
      .def_readonly("name", &SampleMesh::name)
      .def_readonly("mesh", &SampleMesh::mesh)
      .def_property_readonly(
          "symmetries",
          [](const SampleMesh& sample)
          {
            std::vector<std::pair<Vector, int>> symmetries;
            for (const SampleSymmetry& symmetry : sample.symmetries)
              symmetries.emplace_back(toVector(symmetry.axis), symmetry.fold);
            return symmetries;
          },
          "list of (axis, fold): turns about an axis through the center of its extent, by multiples of 360 / fold "
          "degrees, or with a fold of 0 by any angle, that show the same");
  m.def("sample_mesh_names", &sampleMeshNames, "The names of all sample meshes.");
  m.def("sample_mesh", &sampleMesh, "name"_a, py::call_guard<LeaveGil>(),
        "A sample mesh, closed, the same on every call. Raises ValueError for any other name.");
}

void bindMeshes(py::module& m)
{
  bindMesh(m);
  bindReading(m);
  bindSamples(m);
}

const Bindings kBindings("meshes", {"geometry"}, bindMeshes);

}  // namespace meshes_bindings
