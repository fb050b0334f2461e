#include "robot_vision/skeleton/skeleton.hpp"

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace skeleton_bindings
{

void bindSkeleton(py::module& m)
{
  bindParams<SkeletonParams>(m, "SkeletonParams", "What measure_skeleton() takes for bright.");

  m.def(
      "measure_skeleton",
      [](const py::array& image, const std::string& encoding, const SkeletonParams& params)
      {
        const ImageArray input(image);
        const LeaveGil unlocked;
        return measureSkeleton(input.view, encoding, params);
      },
      "image"_a, "encoding"_a = "bgr8", "params"_a = SkeletonParams(),
      "The share of the pixels that are bright, 0 to 1.\n\n"
      "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
}

const Bindings kBindings("skeleton", {}, bindSkeleton);

}  // namespace skeleton_bindings
