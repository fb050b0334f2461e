#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/faces/face_detector.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace faces_bindings
{

void bindFaces(py::module& m)
{
  bindParams<FaceParams>(m, "FaceParams", "What a FaceDetector searches for, and how often.");

  py::class_<Face>(m, "Face", "A face in a frame.")
      .def_readonly("id", &Face::id, "the same for the same face from frame to frame; -1: not followed")
      .def_property_readonly("box", attribute(&Face::box), "x, y, width, height, px")
      .def_readonly("score", &Face::score, "0 to 1")
      .def_property_readonly("velocity", attribute(&Face::velocity), "px/s, of its middle")
      .def_readonly("predicted", &Face::predicted, "followed by its looks: no cascade has seen it in this frame");

  py::class_<FaceDetector, std::unique_ptr<FaceDetector, DeleteUnlocked<FaceDetector>>>(
      m, "FaceDetector", "Finds faces with OpenCV's cascades, and follows them. Not for two threads at once.")
      .def(py::init<const FaceParams&>(), "params"_a = FaceParams(), Unlocked(),
           "Raises ValueError for a parameter out of range, and for a cascade that is not there or none.")
      .def("configure", &FaceDetector::configure, "params"_a, Unlocked(),
           "Other parameters from now on; the faces remain known. Raises as the constructor does.")
      .def("detect", withArray(&FaceDetector::detect), "image"_a, "encoding"_a = "bgr8",
           "The Faces of an image by itself, the largest first.\n\n"
           "Raises ValueError for an image that is not of this encoding.")
      .def("update", withArray(&FaceDetector::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The Faces in the frame of a time, s, by their id: a new one within max_search_period.\n\n"
           "Raises ValueError for an image that is not of this encoding.")
      .def(
          "find_eyes",
          [](FaceDetector& detector, const Face& face)
          {
            const LeaveGil unlocked;
            std::vector<Box> boxes;
            for (const cv::Rect& eye : detector.findEyes(face))
              boxes.push_back(toPython(eye));
            return boxes;
          },
          "face"_a, "Up to two eyes in a face of the last frame, the left one in the image first: x, y, width, height.")
      .def_property_readonly("search_time", &FaceDetector::searchTime,
                             "s that the last search of a whole image took, 0: none has ended")
      .def("wait_for_search", &FaceDetector::waitForSearch, Unlocked(),
           "Waits for a search in the background: the next update() has what it has found, on a slow machine, too.");
}

const Bindings kBindings("faces", {}, bindFaces);

}  // namespace faces_bindings
