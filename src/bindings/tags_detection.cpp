#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/tags/detection/tag_detector.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace tags_detection_bindings
{

void bindFamilies(py::module& m)
{
  py::class_<TagFamily>(m, "TagFamily", "A family of AprilTags.")
      .def_readonly("name", &TagFamily::name)
      .def_readonly("ids", &TagFamily::ids, "the tags are 0 to ids - 1")
      .def_readonly("width", &TagFamily::width, "cells, side of the image of a tag")
      .def_readonly("width_at_border", &TagFamily::width_at_border,
                    "cells between the corners that are found: the tag's size is measured there")
      .def_readonly("distance", &TagFamily::distance, "bits by which any two tags differ at least");
  m.def("tag_families", &tagFamilies, "All TagFamilies that are known.");
  m.def("tag_family", &tagFamily, "name"_a, "The TagFamily of a name; raises ValueError naming all if it is none.");
  m.def(
      "tag_cells",
      [](const std::string& family, int id)
      { return imageFrom([&](cv::Mat& cells) { cells = tagCells(family, id); }); },
      "family"_a, "id"_a,
      "Image of a tag, upright: (width, width) uint8, a pixel per cell: 0, 255, or 128 where it may have any colour; "
      "see tag_families.hpp.\n\n"
      "The corners that are found are (width - width_at_border) / 2 cells from its edges.\n"
      "Raises ValueError for an unknown family, and for an id that it does not have.");
}

void bindTag(py::module& m)
{
  py::class_<Tag>(m, "Tag", "A tag in an image.")
      .def_readonly("family", &Tag::family)
      .def_readonly("id", &Tag::id)
      .def_readonly("hamming", &Tag::hamming, "wrong bits that were corrected")
      .def_readonly("margin", &Tag::margin, "gray levels, mean distance of the bits from the threshold")
      .def_readonly("similarity", &Tag::similarity, "correlation of the image with the tag's cells, at most 1")
      .def_property_readonly("center", attribute(&Tag::center), "px, where the diagonals meet")
      .def_property_readonly("corners", attribute(&Tag::corners),
                             "(4, 2), px: the upright tag's bottom left, bottom right, top right, top left corner");
}

void bindDetector(py::module& m)
{
  bindParams<TagDetectorParams>(m, "TagDetectorParams", "What a TagDetector searches for, and how.");

  py::class_<TagDetector, std::unique_ptr<TagDetector, DeleteUnlocked<TagDetector>>>(
      m, "TagDetector", "Finds AprilTags with libapriltag; see tag_detector.hpp. Not for two threads at once.")
      .def(py::init<const TagDetectorParams&>(), "params"_a = TagDetectorParams(), Unlocked(),
           "Raises ValueError for a parameter out of range.")
      .def("configure", &TagDetector::configure, "params"_a, Unlocked(),
           "Other parameters from now on; tags remain known. Raises as the constructor does.")
      .def("detect", withArray(&TagDetector::detect), "image"_a, "encoding"_a = "bgr8",
           "All Tags of an image by itself, by family, id and place.\n\n"
           "Raises ValueError for an image that is not of this encoding or too large.")
      .def("update", withArray(&TagDetector::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The Tags in the frame of a time, s: a new one within max_search_period.\n\n"
           "Raises ValueError for an image that is not of this encoding or too large.")
      .def_property_readonly("lacks_threads", &TagDetector::lacksThreads,
                             "whether update() had to search a whole image itself, as no thread could be started")
      .def("wait_for_search", &TagDetector::waitForSearch, Unlocked(),
           "Waits for a search in the background: the next update() has what it has found, on a slow machine, too.")
      .def("abandon_search", &TagDetector::abandonSearch,
           "Has the end of this object not wait for a search in the background: in a process that is about to end. "
           "May be called by any thread.");
}

void bindTags(py::module& m)
{
  bindFamilies(m);
  bindTag(m);
  bindDetector(m);
}

const Bindings kBindings("tags/detection", {}, bindTags);

}  // namespace tags_detection_bindings
