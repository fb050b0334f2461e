#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// A number for each channel, in the network's order.
using ChannelValues = std::array<double, 3>;

struct InputParams
{
  int width = 640;
  int height = 640;
  std::string fit = "letterbox";
  int pad = 114;
  std::string order = "rgb";
  ChannelValues mean = {0.0, 0.0, 0.0};
  ChannelValues std = {255.0, 255.0, 255.0};
  std::string layout = "nchw";

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("width", &InputParams::width, Range{1, 4096}, "px", "of the network's input");
    visit("height", &InputParams::height, Range{1, 4096}, "px", "of the network's input");
    visit("fit", &InputParams::fit, OneOf{"letterbox, stretch or corner"}, "",
          "letterbox keeps the aspect and pads around the image, corner pads below and to the right of it; stretch "
          "fills");
    visit("pad", &InputParams::pad, Range{0, 255}, "", "gray level of the padding, before it is normalised");
    visit("order", &InputParams::order, OneOf{"rgb or bgr"}, "", "of the network's channels");
    visit("mean", &InputParams::mean, Anything{}, "",
          "of each channel, in the network's order, of values from 0 to 255");
    visit("std", &InputParams::std, Anything{}, "", "the input is (value - mean) / std, by channel");
    visit("layout", &InputParams::layout, OneOf{"nchw or nhwc"}, "", "planes of channels, or channels side by side");
  }
};

/// Also throws unless each mean is from -1e6 to 1e6, and each std from 1e-6 to 1e6.
void validate(const InputParams& params);

/// Where a part of an image is in a network's input. Coordinates are continuous: the corner of an image is (0, 0), and
/// the centre of its first pixel (0.5, 0.5). So x of the input is scale_x * (x of the image - x) + left.
struct InputPlacement
{
  double scale_x = 1.0;  // px of the input for one of the image, above 0
  double scale_y = 1.0;
  double left = 0.0;  // px of the input, where the part begins
  double top = 0.0;
  int x = 0;  // px of the image, where the part begins
  int y = 0;
};

/// Writes a part of an image into the input of a network: resized, with its channels in the network's order,
/// normalised, and padded, in one pass. `out` is float32 of 1 x 3 x height x width, or 1 x height x width x 3, without
/// gaps, and of this shape already.
///
/// Letterbox and corner multiply the part's sides by the lower of width / w and height / h, and round them (halves away
/// from 0) to at least 1 px; letterbox leaves half of the rest, rounded down, to the left and at the top. A pixel is
/// sampled where its centre is, as cv::resize does with INTER_LINEAR. All of this is defined in float32, with each
/// operation rounded by itself, and is the same with every instruction set: of two rows, v = a + (b - a) * share; of
/// two such columns likewise; then v * factor + offset with factor = float(1 / std), offset = float(-mean / std). The
/// shares are those of the double (i + 0.5) * (w / resized w) - 0.5, not below 0, beyond its floor, and 0 in the last
/// column or row.
///
/// Throws std::invalid_argument as validate() does, unless `bgr` is an image of three bytes a pixel, if the part is not
/// inside it, and unless `out` has the shape.
InputPlacement fillInput(const cv::Mat& bgr, const cv::Rect& part, const InputParams& params, cv::Mat& out);

}  // namespace robot_vision
