#include "any_image.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/codecs/display_encoder.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace codecs_display_bindings
{

py::bytes encode(DisplayEncoder& encoder, const py::array& image, const std::string& encoding,
                 const DisplayParams& params)
{
  const py::array packed = anyImage(image);
  const cv::Mat view = viewOf(packed);
  std::vector<std::uint8_t> out;
  withoutGil([&] { encoder.encode(view, encoding, params, out); });
  return {reinterpret_cast<const char*>(out.data()), out.size()};
}

void bindDisplay(py::module& m)
{
  bindParams<DisplayParams>(m, "DisplayParams", "How an image is shown.");
  m.attr("WHITE_DEPTH") = kWhiteDepth;

  py::class_<DisplayEncoder>(
      m, "DisplayEncoder",
      "Makes JPEGs and PNGs of images to look at. Depths (16UC1 in mm, 32FC1 and 64FC1 in m) are "
      "gray, 255 * sqrt(depth / WHITE_DEPTH), and black where there is none. Labels (8SC1, 16SC1, "
      "32SC1, and mono16 without a number above 255) have colours. Threads must not share one.")
      .def(py::init<>())
      .def("encode", &encode, "image"_a, "encoding"_a, "params"_a,
           "The bytes of an image as it came, of any encoding of sensor_msgs: resized (by areas where it becomes "
           "smaller) and turned.\n\n"
           "Raises ValueError for parameters out of range, an encoding that cannot be shown, and an image that is not "
           "of it, TypeError for an array that is no image.");
}

const Bindings kBindings("codecs_display", {}, bindDisplay);

}  // namespace codecs_display_bindings
