#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/flow/dense_flow.hpp"
#include "robot_vision/flow/flow_drawing.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace flow_bindings
{

/// A view of an array of a flow, which must outlive it.
cv::Mat flowView(const FloatArray& flow)
{
  if (flow.ndim() != 3 || flow.shape(2) != 2) throw py::value_error("expected a (height, width, 2) array of a flow");
  return {static_cast<int>(flow.shape(0)), static_cast<int>(flow.shape(1)), CV_32FC2, const_cast<float*>(flow.data())};
}

void bindFunctions(py::module& m)
{
  m.def(
      "mean_flow", [](const FloatArray& flow) { return toPython(meanFlow(flowView(flow))); }, "flow"_a,
      "The mean (x, y) of a flow, (height, width, 2) float32, in its unit.\n\nRaises ValueError for what is none.");
  m.def(
      "median_flow", [](const FloatArray& flow) { return toPython(medianFlow(flowView(flow))); }, "flow"_a,
      "The median of x and that of y of a flow, (height, width, 2) float32: how most of the image moves. As of the "
      "mean, "
      "each is NaN if it is for a pixel.\n\n"
      "Raises ValueError for what is none.");
  m.def(
      "flow_to_colors",
      [](const FloatArray& flow, double max_speed)
      {
        const cv::Mat view = flowView(flow);
        return imageFrom([&](cv::Mat& bgr) { flowToColors(view, max_speed, bgr); });
      },
      "flow"_a, "max_speed"_a = 0.0,
      "A flow, (height, width, 2) float32 px, as a (height, width, 3) BGR image: the hue is the angle, red to the "
      "right "
      "and yellow-green down, the brightness the speed in max_speed, px; 0: in the largest of the image, and 1 at "
      "least.\n\n"
      "Raises ValueError for what is no flow, and a speed out of range.");
  m.def(
      "draw_flow_arrows",
      [](const py::array& bgr, const FloatArray& flow, int spacing, double scale)
      {
        cv::Mat image = canvas(bgr);
        const cv::Mat view = flowView(flow);
        const LeaveGil unlocked;
        drawFlowArrows(image, view, spacing, scale);
      },
      "bgr"_a, "flow"_a, "spacing"_a = 16, "scale"_a = 3.0,
      "Draws an arrow for every `spacing` px of a flow, (height, width, 2) float32 px, `scale` times as long, on the "
      "image, (height, width, 3) uint8.\n\n"
      "Raises ValueError for an array that cannot be drawn on, and a flow of another size.");
}

void bindFlow(py::module& m)
{
  bindParams<DenseFlowParams>(m, "DenseFlowParams", "How a DenseFlow is found.");
  bindParams<FlowDrawingParams>(m, "FlowDrawingParams", "How the node dense_flow draws a flow.");

  const auto update = [](DenseFlow& finder, double time, const py::array& image,
                         const std::string& encoding) -> std::optional<py::array>
  {
    const ImageArray input(image);
    cv::Mat flow;
    {
      const LeaveGil unlocked;
      flow = finder.update(time, input.view, encoding);
    }
    if (flow.empty()) return std::nullopt;
    return toPython(flow);
  };
  py::class_<DenseFlow>(m, "DenseFlow",
                        "Finds how far each pixel has moved since the last frame. Threads may share one; their calls "
                        "wait for each other.")
      .def(py::init<const DenseFlowParams&>(), "params"_a = DenseFlowParams())
      .def(
          "update", update, "time"_a, "image"_a, "encoding"_a = "bgr8",
          "The flow from the last frame to the one of a time, s: (height, width, 2) float32, px to the right and down. "
          "None for the first frame, one of another size, of an earlier time, or of more than max_gap later.\n\n"
          "Raises ValueError for an image that is not of this encoding.")
      .def_property_readonly(
          "interval", [](const DenseFlow& finder) { return withoutGil([&] { return finder.interval(); }); },
          "s, between the two frames of the last flow; 0 if there was none")
      .def("reset", &DenseFlow::reset, Unlocked(), "The next frame is the first one.");
  bindFunctions(m);
}

const Bindings kBindings("flow", {}, bindFlow);

}  // namespace flow_bindings
