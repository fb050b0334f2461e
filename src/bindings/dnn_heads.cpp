#include <pybind11/stl.h>

#include <array>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/dnn/box_outline.hpp"
#include "robot_vision/dnn/head_decoder.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace dnn_heads_bindings
{

using Numbers = py::array_t<float, py::array::c_style | py::array::forcecast>;

std::vector<FoundObject> decode(const HeadDecoder& decoder, const std::vector<Numbers>& outputs,
                                const InputPlacement& placement, const std::pair<int, int>& image_size)
{
  std::vector<NetworkOutput> views;
  for (const Numbers& output : outputs)
    views.push_back({{output.shape(), output.shape() + output.ndim()}, output.data()});
  const LeaveGil unlocked;
  return decoder.decode(views, placement, {image_size.first, image_size.second});
}

/// Of a (4, 2) array.
using Corners = std::array<std::array<double, 2>, 4>;

BoxOutline toOutline(const Corners& corners)
{
  BoxOutline outline;
  for (std::size_t i = 0; i < outline.size(); ++i)
    outline[i] = {corners[i][0], corners[i][1]};
  return outline;
}

std::pair<double, double> overlapsOf(const Corners& first, const Corners& second)
{
  const BoxOutline a = toOutline(first), b = toOutline(second);
  const double shared = sharedArea(a, b), area_a = areaOf(a), area_b = areaOf(b);
  return {shared / (area_a + area_b - shared), shared / area_a};
}

/// (k, 3) array.
py::array_t<float> toPython(const std::vector<ObjectKeypoint>& keypoints)
{
  return py::array_t<float>({static_cast<py::ssize_t>(keypoints.size()), py::ssize_t{3}},
                            keypoints.empty() ? nullptr : &keypoints[0].x);
}

void bindFoundObject(py::module& m)
{
  py::class_<FoundObject>(m, "FoundObject", "An object that a network has found in an image.")
      .def_readonly("class_id", &FoundObject::class_id)
      .def_readonly("score", &FoundObject::score, "the network's, 0 to 1")
      .def_property_readonly(
          "box", [](const FoundObject& o) { return std::make_tuple(o.box.x0, o.box.y0, o.box.x1, o.box.y1); },
          "x0, y0, x1, y1, px of the whole image, inside of it; (0, 0) is the corner of the image")
      .def_property_readonly(
          "box_pixels", [](const FoundObject& o) { return robot_vision::toPython(pixelsOf(o.box)); },
          "x, y, width, height of the pixels that the box touches: those of the mask")
      .def_property_readonly(
          "center", [](const FoundObject& o) { return robot_vision::toPython(o.center()); },
          "x, y, px: the middle of the outline or, without one, of the box")
      .def_property_readonly(
          "outline", [](const FoundObject& o) { return robot_vision::toPython(o.outline); },
          "(4, 2) float32 array of the corners of an oriented box, px, clockwise, which may be outside of the image; "
          "else (0, 2)")
      .def_property_readonly(
          "keypoints", [](const FoundObject& o) { return toPython(o.keypoints); },
          "(k, 3) float32 array of x, y, px, and the score, 0 to 1; a keypoint that the network gave no finite number "
          "for is 0, 0, 0; (0, 3) without a pose")
      .def_property_readonly(
          "mask", [](const FoundObject& o) { return robot_vision::toPython(o.mask); },
          "(height, width) uint8 array of box_pixels, 255 on the object, else 0; (0, 0) without one");
}

void bindHeads(py::module& m)
{
  bindParams<HeadParams>(m, "HeadParams", "How the outputs of a network are decoded.");
  bindFoundObject(m);

  m.def(
      "box_pixels",
      [](const std::array<double, 4>& box) {
        return robot_vision::toPython(pixelsOf({box[0], box[1], box[2], box[3]}));
      },
      "box"_a,
      "x, y, width, height of the pixels that a box x0, y0, x1, y1 touches by more than a thousandth of a pixel; one "
      "at least.");

  m.def("outline_overlaps", overlapsOf, "outline"_a, "other"_a,
        "Of two oriented boxes, (4, 2) arrays of corners, clockwise: the intersection over union, and over the area of "
        "the first one.");

  py::class_<HeadDecoder>(m, "HeadDecoder", "Makes objects of what a network gives. Threads may share one.")
      .def(py::init<const HeadParams&>(), "params"_a = HeadParams(), "Raises ValueError for a parameter out of range.")
      .def("decode", decode, "outputs"_a, "placement"_a, "image_size"_a,
           "The objects in an image, the surest first. `outputs` are float32 arrays, in the network's order, "
           "`placement` "
           "is what fill_input() returned, `image_size` the (width, height) of the whole image.\n\nRaises ValueError "
           "naming the head, the shape seen and the one expected for outputs that are not the head's.");
}

const Bindings kBindings("dnn_heads", {"dnn_input"}, bindHeads);

}  // namespace dnn_heads_bindings
