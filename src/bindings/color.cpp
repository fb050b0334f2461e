#include <pybind11/stl.h>

#include <tuple>

#include "arrays.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/color/hsv.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace color_bindings
{

using Color = std::tuple<int, int, int>;
using Bytes = std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>;

void setLow(HsvRange& range, const Color& low)
{
  std::tie(range.h_low, range.s_low, range.v_low) = low;
}

void setHigh(HsvRange& range, const Color& high)
{
  std::tie(range.h_high, range.s_high, range.v_high) = high;
}

Color low(const HsvRange& range)
{
  return {range.h_low, range.s_low, range.v_low};
}

Color high(const HsvRange& range)
{
  return {range.h_high, range.s_high, range.v_high};
}

HsvRange makeRange(const Color& low, const Color& high)
{
  HsvRange range;
  setLow(range, low);
  setHigh(range, high);
  return range;
}

cv::Vec3b toVec(const Bytes& color)
{
  const auto [first, second, third] = color;
  return {first, second, third};
}

py::array applyMask(const HsvMask& mask, const py::array& image, const std::string& encoding)
{
  const ImageArray input(image);
  return imageFrom([&](cv::Mat& output) { mask.apply(input.view, encoding, output); });
}

void bindRange(py::module& m)
{
  py::class_<HsvRange> range(
      m, "HsvRange",
      "Colours from low to high, both (h, s, v) in 8-bit HSV as OpenCV has it: hue in half degrees "
      "(0..180), saturation and value (0..255). A low hue above the high one: through red.");
  range.def(py::init(&makeRange), "low"_a = low(HsvRange()), "high"_a = high(HsvRange()))
      .def_property("low", &low, &setLow, "(h_low, s_low, v_low)")
      .def_property("high", &high, &setHigh, "(h_high, s_high, v_high)");
  bindFields(m, range);
  m.def(
      "range_around", [](const Bytes& hsv, int margin) { return rangeAround(toVec(hsv), margin); }, "hsv"_a,
      "margin"_a = 10,
      "The HsvRange to begin with for a colour (h, s, v): hue +- margin (0..90), saturation and value from 100 to "
      "255.");
  m.def(
      "to_hsv",
      [](const Bytes& bgr)
      {
        const cv::Vec3b hsv = toHsv(toVec(bgr));
        return Color(hsv[0], hsv[1], hsv[2]);
      },
      "bgr"_a, "The colour (b, g, r) as (h, s, v), as cv2.cvtColor converts it.");
  m.def(
      "bgr_of_hsv",
      [](const Bytes& hsv)
      {
        const cv::Vec3b bgr = bgrOfHsv(toVec(hsv));
        return Color(bgr[0], bgr[1], bgr[2]);
      },
      "hsv"_a, "A colour (b, g, r) that has this (h, s, v) as nearly as 8 bits allow, as cv2.cvtColor converts it.");
}

void bindMask(py::module& m)
{
  const char* doc =
      "(height, width) uint8, 255 where the colour is in the range and 0 elsewhere: cv2.cvtColor to HSV and "
      "cv2.inRange, to the bit.\n\n"
      "Raises ValueError for a range that is none or an image that is not of this encoding.";
  py::class_<HsvMask>(m, "HsvMask",
                      "The pixels whose colour is in a range, for one image after the other. Threads may share one.")
      .def(py::init<const HsvRange&>(), "range"_a = HsvRange())
      .def("apply", &applyMask, "image"_a, "encoding"_a = "bgr8", doc);
  m.def(
      "hsv_mask",
      [](const py::array& image, const HsvRange& range, const std::string& encoding)
      { return applyMask(HsvMask(range), image, encoding); },
      "image"_a, "range"_a = HsvRange(), "encoding"_a = "bgr8", doc);
}

void bindColor(py::module& m)
{
  bindRange(m);
  bindMask(m);
}

const Bindings kBindings("color", {}, bindColor);

}  // namespace color_bindings
