#include "robot_vision/spectrum/spectrum.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace spectrum_bindings
{

using Size = std::pair<int, int>;  // height, width, as NumPy has them

void bindFunctions(py::module& m)
{
  m.def(
      "spectrum_magnitude",
      [](const py::array& image, const std::string& encoding, const SpectrumParams& params)
      {
        const ImageArray input(image);
        return imageFrom([&](cv::Mat& magnitude) { magnitude = spectrumMagnitude(input.view, encoding, params); });
      },
      "image"_a, "encoding"_a = "bgr8", "params"_a = SpectrumParams(),
      "log(1 + magnitude) of the discrete Fourier transform of the gray image, (rows, columns) float32, with frequency "
      "0 "
      "at row rows // 2 and column columns // 2.\n\n"
      "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
  m.def(
      "spectrum_image",
      [](const FloatArray& magnitude)
      {
        const cv::Mat view = floatView(magnitude, "(rows, columns) array of a magnitude");
        return imageFrom([&](cv::Mat& image) { image = spectrumImage(view); });
      },
      "magnitude"_a,
      "A magnitude, (rows, columns) float32, as an image of uint8 to look at: its largest value is 255.\n\n"
      "Raises ValueError for what is no magnitude.");
  m.def(
      "frequency_mask",
      [](const Size& shape, const SpectrumParams& params) {
        return imageFrom([&](cv::Mat& mask) { mask = frequencyMask({shape.second, shape.first}, params); });
      },
      "shape"_a, "params"_a,
      "The factors of a filter for an image of (height, width): (height, width) float32, 0 to 1, centred as "
      "spectrum_magnitude().\n\n"
      "Raises ValueError for a parameter out of range or an empty shape.");
  m.def(
      "draw_passband",
      [](const py::array& bgr, const SpectrumParams& params)
      {
        cv::Mat image = canvas(bgr);
        const LeaveGil unlocked;
        drawPassband(image, params);
      },
      "bgr"_a, "params"_a,
      "Draws the borders of a filter on the image of a spectrum, (rows, columns, 3) uint8.\n\n"
      "Raises ValueError for a parameter out of range or an array that cannot be drawn on.");
  m.def("filter_frequencies", applyFilter<FrequencyFilter, SpectrumParams>, "image"_a, "encoding"_a = "bgr8",
        "params"_a = SpectrumParams(),
        "The gray image with only the frequencies that the filter keeps: (height, width) float32, gray levels; of "
        "high_pass and band_pass with a mean of 0 over the image filled up with its last row and column, if it is "
        "(optimal_size).\n\n"
        "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
}

void bindSpectrum(py::module& m)
{
  bindParams<SpectrumParams>(m, "SpectrumParams", "What is done with the Fourier transform of an image.");
  bindFunctions(m);

  py::class_<ImageShift>(m, "ImageShift", "How far an image has moved as a whole.")
      .def_readonly("x", &ImageShift::x, "px to the right since the last frame; 0 if not found")
      .def_readonly("y", &ImageShift::y, "px down")
      .def_readonly("response", &ImageShift::response, "share of the correlation that is around its peak, 0 to 1")
      .def_readonly("found", &ImageShift::found, "whether the response is at least min_response and above 0");

  py::class_<PhaseCorrelator>(
      m, "PhaseCorrelator",
      "Finds how far the image has moved since the last frame. Threads may share one; their calls wait for each other.")
      .def(py::init<const SpectrumParams&>(), "params"_a = SpectrumParams())
      .def("update", withArray(&PhaseCorrelator::update), "time"_a, "image"_a, "encoding"_a = "bgr8",
           "The ImageShift from the last frame to the one of a time, s. None for the first frame, one of another size, "
           "of an earlier time, or of more than max_gap later.\n\n"
           "Raises ValueError for an image that is not of this encoding.")
      .def_property_readonly(
          "interval", [](const PhaseCorrelator& finder) { return withoutGil([&] { return finder.interval(); }); },
          "s, between the two frames of the last shift; 0 if there was none")
      .def("reset", &PhaseCorrelator::reset, Unlocked(), "The next frame is the first one.");
}

const Bindings kBindings("spectrum", {}, bindSpectrum);

}  // namespace spectrum_bindings
