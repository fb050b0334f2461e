#include "robot_vision/histogram/histogram.hpp"

#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/histogram/histogram_plot.hpp"
#include "robot_vision/histogram/hue_saturation.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace histogram_bindings
{

cv::Mat toCounts(const FloatArray& counts)
{
  return floatView(counts, "histogram of 2 dimensions");
}

void bindChannels(py::module& m)
{
  bindParams<HistogramParams>(m, "HistogramParams", "What compute_histogram() counts.");

  py::class_<ChannelHistogram>(m, "ChannelHistogram", "How many pixels have which value of one channel.")
      .def_readonly("name", &ChannelHistogram::name,
                    "gray; blue, green, red; hue, saturation, value; lightness, a, b; luma, cr, cb")
      .def_readonly("low", &ChannelHistogram::low, "where the first bin begins")
      .def_readonly("high", &ChannelHistogram::high, "where the last bin ends; no pixel has this value")
      .def_property_readonly(
          "counts",
          [](const ChannelHistogram& channel)
          { return py::array_t<std::int32_t>(static_cast<py::ssize_t>(channel.counts.size()), channel.counts.data()); },
          "(bins,) int32 px, the pixels in each bin");

  m.def(
      "part_of",
      [](const std::pair<int, int>& size, const Box& region) {
        return toPython(partOf({size.first, size.second}, toRect(region)));
      },
      "size"_a, "region"_a,
      "The part of an image of a size (width, height) that a region (x, y, width, height) means, px: a width or height "
      "of 0 reaches to the border.\n\nRaises ValueError if it is not inside of the image.");
  m.def(
      "compute_histogram",
      [](const py::array& image, const std::string& encoding, const HistogramParams& params, const Box& region,
         const std::optional<py::array>& mask)
      {
        const ImageArray input(image);
        const ImageArray where(mask.value_or(image));
        const LeaveGil unlocked;
        return computeHistogram(input.view, encoding, params, toRect(region), mask ? where.view : cv::Mat());
      },
      "image"_a, "encoding"_a = "bgr8", "params"_a = HistogramParams(), "region"_a = Box{0, 0, 0, 0},
      "mask"_a = py::none(),
      "The ChannelHistograms of a region (x, y, width, height) of an image, where the (height, width) uint8 mask is "
      "not "
      "0.\n\nRaises ValueError for an image that is not of this encoding, and for a region or mask that does not fit.");
}

void bindHueSaturation(py::module& m)
{
  bindParams<HueSaturationParams>(m, "HueSaturationParams",
                                  "The bins of hue_saturation_histogram(), and what back_project() does.");
  m.def(
      "hue_saturation_histogram",
      [](const py::array& image, const std::string& encoding, const HueSaturationParams& params, const Box& region)
      {
        const ImageArray input(image);
        return imageFrom([&](cv::Mat& counts)
                         { counts = hueSaturationHistogram(input.view, encoding, params, toRect(region)); });
      },
      "image"_a, "encoding"_a = "bgr8", "params"_a = HueSaturationParams(), "region"_a = Box{0, 0, 0, 0},
      "(hue_bins, saturation_bins) float32 px, of a region (x, y, width, height) of an image.\n\n"
      "Raises ValueError for an image that is not of this encoding, and for a region that is not inside of it.");
  m.def(
      "back_project",
      [](const py::array& image, const FloatArray& histogram, const std::string& encoding,
         const HueSaturationParams& params)
      {
        const ImageArray input(image);
        const cv::Mat counts = toCounts(histogram);
        return imageFrom([&](cv::Mat& out) { backProject(input.view, encoding, counts, params, out); });
      },
      "image"_a, "histogram"_a, "encoding"_a = "bgr8", "params"_a = HueSaturationParams(),
      "(height, width) uint8: how frequent the colour of each pixel is in a histogram of "
      "hue_saturation_histogram().\n\n"
      "Raises ValueError for an image that is not of this encoding, and for a histogram of other bins.");
  m.def(
      "compare_histograms",
      [](const FloatArray& a, const FloatArray& b, const std::string& method)
      { return compareHistograms(toCounts(a), toCounts(b), method); },
      "a"_a, "b"_a, "method"_a = "correlation",
      "How alike two histograms are by correlation, chi_square, intersection or bhattacharyya.\n\n"
      "Raises ValueError for another method, and for histograms of different sizes.");
}

void bindPlot(py::module& m)
{
  bindParams<HistogramPlotParams>(m, "HistogramPlotParams", "How plot_histogram() draws.");
  m.def(
      "plot_histogram",
      [](const py::array& bgr, const std::vector<ChannelHistogram>& histogram, const HistogramPlotParams& params)
      {
        const ImageArray image(bgr);
        return imageFrom([&](cv::Mat& out) { plotHistogram(image.view, histogram, params, out); });
      },
      "bgr"_a, "histogram"_a, "params"_a = HistogramPlotParams(),
      "A new image with the curves of the histogram on the image, (height, width, 3) uint8, or beside it.\n\n"
      "Raises ValueError for what is no such image.");
  m.def(
      "draw_hue_saturation",
      [](const FloatArray& histogram, const HistogramPlotParams& params)
      {
        const cv::Mat counts = toCounts(histogram);
        return imageFrom([&](cv::Mat& out) { drawHueSaturation(counts, params, out); });
      },
      "histogram"_a, "params"_a = HistogramPlotParams(),
      "(256, 360, 3) uint8: two columns for a hue, a row for a saturation, from 0 at the bottom; a colour is as bright "
      "as its bin is full.\n\nRaises ValueError for what is no such histogram.");
}

void bindHistogram(py::module& m)
{
  bindChannels(m);
  bindHueSaturation(m);
  bindPlot(m);
}

const Bindings kBindings("histogram", {}, bindHistogram);

}  // namespace histogram_bindings
