#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <opencv2/core/utility.hpp>
#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "robot_vision/ball/ball_tracker.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/codecs/image_file.hpp"
#include "robot_vision/codes/code_reader.hpp"
#include "robot_vision/color/hsv.hpp"
#include "robot_vision/edges/edges.hpp"
#include "robot_vision/faces/face_detector.hpp"
#include "robot_vision/filters/brightness.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/line/line.hpp"
#include "robot_vision/motion/motion.hpp"
#include "robot_vision/scene/scene.hpp"
#include "robot_vision/segmentation/regions.hpp"
#include "robot_vision/tags/detection/tag_detector.hpp"
#include "robot_vision/tags/pose/tag_pose_tracker.hpp"
#include "robot_vision/tracking/object_tracker.hpp"

using namespace robot_vision;
using namespace py::literals;

void bindBall(py::module& m);
void bindCodes(py::module& m);
void bindColors(py::module& m);
void bindFaces(py::module& m);
void bindLine(py::module& m);
void bindMotion(py::module& m);
void bindObjectTracker(py::module& m);
void bindOverlay(py::module& m);
void bindScene(py::module& m);
void bindTagPoses(py::module& m);
void bindTags(py::module& m);

namespace
{

constexpr const char* kLayout =
    "Pictures are (height, width) or (height, width, channels) arrays of uint8 or, for 16-bit encodings, uint16. They "
    "are used without a copy if their pixels lie side by side in each row; rows may be padded.";

template <class Filter, class Params>
py::array apply(const py::array& image, const std::string& encoding, const Params& params)
{
  const Picture input(image);
  cv::Mat output;
  {
    const LeaveGil unlocked;
    Filter(params).apply(input.view, encoding, output);
  }
  return toNumpy(output);
}

void bindFilters(py::module& m)
{
  py::class_<BrightnessParams>(m, "BrightnessParams", "Gain (0..10), offset (-255..255 grey levels), gamma (0.1..10).")
      .def(py::init<>())
      .def_readwrite("gain", &BrightnessParams::gain)
      .def_readwrite("offset", &BrightnessParams::offset)
      .def_readwrite("gamma", &BrightnessParams::gamma)
      .def_readwrite("threads", &BrightnessParams::threads);
  m.def(
      "adjust_brightness", apply<Brightness, BrightnessParams>, "image"_a, "encoding"_a = "bgr8",
      "params"_a = BrightnessParams(),
      "255 * (clip(gain * image + offset) / 255) ** gamma, in the image's own encoding, or bgr8 for Bayer and YUV.\n\n"
      "Raises ValueError for a parameter out of range or an image that is not of this encoding.");

  py::class_<EdgeParams>(m, "EdgeParams", "Box blur (odd px), Canny thresholds, Sobel aperture (3, 5, 7), L2 norm.")
      .def(py::init<>())
      .def_readwrite("blur_size", &EdgeParams::blur_size)
      .def_readwrite("low_threshold", &EdgeParams::low_threshold)
      .def_readwrite("high_threshold", &EdgeParams::high_threshold)
      .def_readwrite("aperture", &EdgeParams::aperture)
      .def_readwrite("l2_gradient", &EdgeParams::l2_gradient)
      .def_readwrite("threads", &EdgeParams::threads);
  m.def("find_edges", apply<EdgeDetector, EdgeParams>, "image"_a, "encoding"_a = "bgr8", "params"_a = EdgeParams(),
        "Canny edges of the blurred grey picture: (height, width) uint8, 255 on edges and 0 elsewhere.\n\n"
        "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
  m.def("encodings", &encodings, "The pixel layouts that are known, named as in sensor_msgs/image_encodings.");
}

/// None: it is no image.
std::optional<py::array> decodeFile(const py::buffer& data, int flags)
{
  const py::buffer_info bytes = data.request();
  if (bytes.ndim != 1 || bytes.strides[0] != bytes.itemsize) throw py::value_error("expected bytes in a row");
  cv::Mat image;
  {
    const LeaveGil unlocked;
    image = decodeImageFile(static_cast<const unsigned char*>(bytes.ptr),
                            static_cast<std::size_t>(bytes.size * bytes.itemsize), flags);
  }
  if (image.empty()) return std::nullopt;
  return toNumpy(image);
}

void bindSources(py::module& m)
{
  py::class_<CaptureParams>(m, "CaptureParams",
                            "What a camera is asked for; see frame_source.hpp for units and ranges.")
      .def(py::init<>())
      .def_readwrite("source", &CaptureParams::source)
      .def_readwrite("video_device", &CaptureParams::video_device)
      .def_readwrite("image_width", &CaptureParams::image_width)
      .def_readwrite("image_height", &CaptureParams::image_height)
      .def_readwrite("pixel_format", &CaptureParams::pixel_format)
      .def_readwrite("io_method", &CaptureParams::io_method)
      .def_readwrite("framerate", &CaptureParams::framerate)
      .def_readwrite("timeout", &CaptureParams::timeout)
      .def_readwrite("scene", &CaptureParams::scene)
      .def_readwrite("poster", &CaptureParams::poster);
  m.def("decode_image_file", &decodeFile, "data"_a, "flags"_a,
        "The image of a file's bytes, read with cv2.IMREAD_... flags; None if it is none, or damaged.\n\n"
        "Raises ValueError if its header claims more pixels than fit into memory beside others.");
}

/// What OpenCV itself does with a picture in several threads.
void bindThreads(py::module& m)
{
  m.def(
      "set_threads", [](int count) { cv::setNumThreads(count > 0 ? count : cv::getNumberOfCPUs()); }, "count"_a,
      "How many threads of OpenCV's share the work on one picture, in this process; 0: as many as there are cores.");
}

/// validate(params) for every kind of parameters.
void bindValidate(py::module& m)
{
  const char* doc = "Raises ValueError naming the first parameter out of range, its value and the range.";
  m.def("validate", py::overload_cast<const BallTrackerParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const BrightnessParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const CodeReaderParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const EdgeParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const FaceParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const CaptureParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const HsvRange&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const LineParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const RegionParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const MotionParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const ObjectTrackerParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const SceneParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const TagDetectorParams&>(&validate), "params"_a, doc);
  m.def("validate", py::overload_cast<const TagPoseParams&>(&validate), "params"_a, doc);
}

}  // namespace

PYBIND11_MODULE(_core, m)
{
  m.doc() = std::string("The C++ core of robot_vision on NumPy arrays. ") + kLayout;
  LeaveGil::endWithProcess();
  bindFilters(m);
  bindSources(m);
  bindThreads(m);
  bindScene(m);
  bindCodes(m);
  bindColors(m);
  bindBall(m);
  bindFaces(m);
  bindLine(m);
  bindMotion(m);
  bindObjectTracker(m);
  bindOverlay(m);
  bindTagPoses(m);
  bindTags(m);
  bindValidate(m);
}
