#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/color/color_range.hpp"
#include "robot_vision/color/color_space.hpp"
#include "robot_vision/image/encoding.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace color_spaces_bindings
{

using Color = std::tuple<int, int, int>;
using Bytes = std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>;

cv::Vec3b toVec(const Bytes& color)
{
  const auto [first, second, third] = color;
  return {first, second, third};
}

Color toColor(const cv::Vec3i& color)
{
  return {color[0], color[1], color[2]};
}

cv::Vec3i toVec3i(const Color& color)
{
  const auto [first, second, third] = color;
  return {first, second, third};
}

ColorRange makeColorRange(const std::string& space, const Color& low, const Color& high)
{
  return {space, toVec3i(low), toVec3i(high)};
}

/// name, meaning, and the highest limit of each channel.
std::vector<std::tuple<std::string, std::string, int>> channelsOf(const std::string& space)
{
  std::vector<std::tuple<std::string, std::string, int>> channels;
  for (const ColorChannel& channel : colorChannels(space))
    channels.emplace_back(channel.name, channel.meaning, channel.max);
  return channels;
}

py::array applyMask(const ColorMask& mask, const py::array& image, const std::string& encoding)
{
  const ImageArray input(image);
  return imageFrom([&](cv::Mat& output) { mask.apply(input.view, encoding, output); });
}

void bindSpaces(py::module& m)
{
  m.def("color_spaces", &colorSpaces, "The names of the spaces that colours are given in: hsv, hls, lab, ...");
  m.def("color_channels", &channelsOf, "space"_a,
        "The channels of a space: (name, meaning, highest limit) of each; 180 half degrees of a hue, else 255.\n\n"
        "Raises ValueError naming the space if it is none.");
  m.def(
      "to_space", [](const Bytes& bgr, const std::string& space) { return toColor(toSpace(toVec(bgr), space)); },
      "bgr"_a, "space"_a,
      "The colour (b, g, r) in a space, in 8 bits as cv2.cvtColor converts it in the middle of an image.\n\n"
      "Raises ValueError naming the space if it is none.");
  m.def(
      "image_to_space",
      [](const py::array& image, const std::string& space, const std::string& encoding)
      {
        const ImageArray input(image);
        return imageFrom(
            [&](cv::Mat& output)
            {
              toSpace(input.view, encoding, space, output);
              if (sharesPixels(output, input.view)) output = output.clone();
            });
      },
      "image"_a, "space"_a, "encoding"_a = "bgr8",
      "(height, width, 3) uint8: the image in a space, as cv2.cvtColor converts it.\n\n"
      "Raises ValueError for a space that is none or an image that is not of this encoding.");
}

void bindColorRange(py::module& m)
{
  const ColorRange usual;
  py::class_<ColorRange>(m, "ColorRange",
                         "Colours from low to high in a space (see color_spaces()), the limits in the order of its "
                         "channels: 0..255, of hues in half degrees 0..180. A low hue above the high one: through red.")
      .def(py::init(&makeColorRange), "space"_a = usual.space, "low"_a = toColor(usual.low),
           "high"_a = toColor(usual.high))
      .def_readwrite("space", &ColorRange::space, "one of color_spaces()")
      .def_property(
          "low", [](const ColorRange& range) { return toColor(range.low); },
          [](ColorRange& range, const Color& low) { range.low = toVec3i(low); }, "lowest of each channel")
      .def_property(
          "high", [](const ColorRange& range) { return toColor(range.high); },
          [](ColorRange& range, const Color& high) { range.high = toVec3i(high); }, "highest of each channel")
      .def(
          "__eq__",
          [](const ColorRange& a, const ColorRange& b)
          { return a.space == b.space && a.low == b.low && a.high == b.high; },
          "other"_a, py::is_operator());
  m.def(
      "validate", [](const ColorRange& range) { validate(range); }, "params"_a,
      "Raises ValueError naming the first parameter out of range, its value and the range.");
  m.def(
      "range_around",
      [](const Bytes& color, const std::string& space, const std::optional<int>& margin)
      { return rangeAround(toVec(color), space, margin ? *margin : defaultMargin(space)); },
      "color"_a, "space"_a, "margin"_a = std::nullopt,
      "The ColorRange to begin with for a colour of a space: hues, and channels of spaces without hue, +- margin "
      "(0..90; None: default_margin(space)).");
  m.def("default_margin", &defaultMargin, "space"_a, "10 half degrees in spaces with a hue, and 20 in others.");
  m.def(
      "convert_range",
      [](const ColorRange& range, const std::string& space)
      {
        const LeaveGil unlocked;
        return convertRange(range, space);
      },
      "range"_a, "space"_a,
      "The smallest ColorRange in a space that holds all colours of another range, in some tenths of a second.\n\n"
      "Raises ValueError for a range or a space that is none, and for a range that holds no colour.");
}

void bindColorMask(py::module& m)
{
  const char* doc =
      "(height, width) uint8, 255 where the colour is in the range and 0 elsewhere: cv2.cvtColor to its space and "
      "cv2.inRange, to the bit.\n\n"
      "Raises ValueError for a range that is none or an image that is not of this encoding.";
  py::class_<ColorMask>(
      m, "ColorMask",
      "The pixels whose colour is in a range of a space, for one image after another. Threads may share one.")
      .def(py::init<const ColorRange&>(), "range"_a = ColorRange())
      .def("apply", &applyMask, "image"_a, "encoding"_a = "bgr8", doc);
}

void bindColorSpaces(py::module& m)
{
  bindSpaces(m);
  bindColorRange(m);
  bindColorMask(m);
}

const Bindings kBindings("color/spaces", {"color"}, bindColorSpaces);

}  // namespace color_spaces_bindings
