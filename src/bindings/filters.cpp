#include "robot_vision/filters/brightness.hpp"

#include "arrays.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
{

void bindFilters(py::module& m)
{
  bindParams<BrightnessParams>(m, "BrightnessParams", "What adjust_brightness() does.");
  m.def(
      "adjust_brightness", applyFilter<Brightness, BrightnessParams>, "image"_a, "encoding"_a = "bgr8",
      "params"_a = BrightnessParams(),
      "255 * (clip(gain * image + offset) / 255) ** gamma, in the image's own encoding, or bgr8 for Bayer and YUV.\n\n"
      "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
}

const Bindings kBindings("filters", {}, bindFilters);

}  // namespace
