#include "robot_vision/segmentation/segmenter.hpp"

#include <pybind11/stl.h>

#include <utility>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace segmenter_bindings
{

void bindResults(py::module& m)
{
  py::class_<Segmentation>(m, "Segmentation", "What a Segmenter found in an image.")
      .def_property_readonly("labels", attribute(&Segmentation::labels),
                             "(height, width) uint16: 1, 2, ... are segments; 0 is background, a line, or left out")
      .def_property_readonly("centers", attribute(&Segmentation::centers),
                             "(n, 3) float32, BGR: of k_means, the colour of each label; else empty")
      .def_readonly("hint", &Segmentation::hint, "what the method lacks, in words; empty: nothing");

  py::class_<SegmentSeed>(m, "SegmentSeed", "What somebody has pointed at, px of the whole image.")
      .def_property_readonly("region", attribute(&SegmentSeed::region), "(x, y, width, height); 0x0 for a click")
      .def_property_readonly(
          "point", [](const SegmentSeed& seed) { return std::make_pair(seed.point.x, seed.point.y); },
          "(x, y), clicked, or the middle of the region");

  py::class_<Segment>(m, "Segment", "A segment of a label image.")
      .def_readonly("label", &Segment::label)
      .def_readonly("region", &Segment::region,
                    "outline and circle are of its largest piece; area, box and centre of all pixels");
}

void bindSegmenter(py::module& m)
{
  bindParams<SegmenterParams>(m, "SegmenterParams", "How a Segmenter divides images.");
  bindParams<SegmentPaintParams>(m, "SegmentPaintParams", "How paint_segments() paints.");
  bindResults(m);

  py::class_<Segmenter>(
      m, "Segmenter",
      "Divides images into segments by OpenCV's methods. Threads may share one; their calls wait for each other.")
      .def(py::init<const SegmenterParams&>(), "params"_a = SegmenterParams(),
           "Raises ValueError for a parameter out of range.")
      .def("configure", &Segmenter::configure, "params"_a, Unlocked(),
           "Other parameters from now on; seeds and numbers stay. Raises as the constructor does.")
      .def(
          "add_region", [](Segmenter& segmenter, const Box& region) { segmenter.addRegion(toRect(region)); },
          "region"_a, Unlocked(),
          "Adds a seed: (x, y, width, height), px. Raises ValueError if it is empty or one too many.")
      .def(
          "add_point",
          [](Segmenter& segmenter, const std::pair<int, int>& point) {
            segmenter.addPoint({point.first, point.second});
          },
          "point"_a, Unlocked(), "Adds a seed: (x, y), px. Raises ValueError if it is one too many.")
      .def("clear_seeds", &Segmenter::clearSeeds, Unlocked())
      .def_property_readonly("seeds",
                             [](const Segmenter& segmenter) { return withoutGil([&] { return segmenter.seeds(); }); })
      .def("apply", withArray(&Segmenter::apply), "image"_a, "encoding"_a = "bgr8",
           "The Segmentation of an image.\n\nRaises ValueError for an image that is not of this encoding.");
}

void bindFunctions(py::module& m)
{
  m.def(
      "find_segments",
      [](const py::array& labels)
      {
        const ImageArray input(labels);
        const LeaveGil unlocked;
        return findSegments(input.view);
      },
      "labels"_a, "The Segments of a (height, width) uint16 label image, the largest first.");
  m.def(
      "paint_segments",
      [](const py::array& bgr, const py::array& labels, const SegmentPaintParams& params)
      {
        const ImageArray image(bgr), where(labels);
        return imageFrom([&](cv::Mat& out) { paintSegments(image.view, where.view, params, out); });
      },
      "bgr"_a, "labels"_a, "params"_a = SegmentPaintParams(),
      "A copy of the image with each segment painted over it, and white lines between them.");
}

void bindAll(py::module& m)
{
  bindSegmenter(m);
  bindFunctions(m);
}

const Bindings kBindings("segmenter", {"segmentation"}, bindAll);

}  // namespace segmenter_bindings
