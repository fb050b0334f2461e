#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/templates/template_matcher.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace templates_bindings
{

/// The view of an array that may be None, which has to live as long.
cv::Mat viewOf(const std::optional<ImageArray>& image)
{
  return image ? image->view : cv::Mat();
}

std::optional<ImageArray> optionalImage(const std::optional<py::array>& array)
{
  return array ? std::optional<ImageArray>(*array) : std::nullopt;
}

void bindResponse(py::module& m)
{
  m.def(
      "template_response",
      [](const py::array& image, const py::array& templ, const std::string& method,
         const std::optional<py::array>& mask)
      {
        const ImageArray pixels(image), wanted(templ);
        const std::optional<ImageArray> counts = optionalImage(mask);
        return imageFrom([&](cv::Mat& out)
                         { out = templateResponse(pixels.view, wanted.view, viewOf(counts), method); });
      },
      "image"_a, "template"_a, "method"_a = "ccoeff_normed", "mask"_a = py::none(),
      "(height, width) float32: how well the template fits at each place, as cv2.matchTemplate says, but never NaN.\n\n"
      "Raises ValueError if sizes or types do not fit, and for a mask if this OpenCV takes none with the method.");
  m.def(
      "response_image",
      [](const FloatArray& response, const std::string& method)
      {
        const cv::Mat view = floatView(response, "(height, width) response");
        return imageFrom([&](cv::Mat& out) { out = responseImage(view, method); });
      },
      "response"_a, "method"_a = "ccoeff_normed",
      "(height, width) uint8: the response with 255 at the best place and 0 at the worst.");
}

void bindMatcher(py::module& m)
{
  py::class_<TemplateMatch>(m, "TemplateMatch", "A place where a template is.")
      .def_readonly("index", &TemplateMatch::index, "of the template, in the order in which they were added")
      .def_readonly("score", &TemplateMatch::score, "0 to 1")
      .def_readonly("scale", &TemplateMatch::scale, "of the template")
      .def_property_readonly("box", attribute(&TemplateMatch::box), "(x, y, width, height), px")
      .def_property_readonly("center", attribute(&TemplateMatch::center), "(x, y), px, sub-pixel");

  py::class_<TemplateMatches>(m, "TemplateMatches", "What a TemplateMatcher finds in an image.")
      .def_readonly("matches", &TemplateMatches::matches, "the best first")
      .def_property_readonly("response", attribute(&TemplateMatches::response),
                             "(height, width) float32, of the template and scale that fit best; empty if not wanted")
      .def_readonly("too_large", &TemplateMatches::too_large, "indices of templates larger than the image");

  py::class_<TemplateMatcher>(m, "TemplateMatcher",
                              "Looks for templates at several scales in images. Threads may share one: they match at "
                              "the same time, and wait while a template is added.")
      .def(py::init<const TemplateParams&>(), "params"_a = TemplateParams())
      .def(
          "add",
          [](TemplateMatcher& matcher, const py::array& image, const std::string& encoding,
             const std::optional<py::array>& mask)
          {
            const ImageArray pixels(image);
            const std::optional<ImageArray> counts = optionalImage(mask);
            const LeaveGil unlocked;
            return matcher.add(pixels.view, encoding, viewOf(counts));
          },
          "image"_a, "encoding"_a = "bgr8", "mask"_a = py::none(),
          "Adds a template; its index. mask: (height, width) uint8, 128 and more for the pixels that count.\n\n"
          "Raises ValueError for a template that the method cannot find anywhere, and for too many.")
      .def(
          "match",
          [](const TemplateMatcher& matcher, const py::array& image, const std::string& encoding, bool response)
          {
            const ImageArray input(image);
            const LeaveGil unlocked;
            return matcher.match(input.view, encoding, response);
          },
          "image"_a, "encoding"_a = "bgr8", "response"_a = false,
          "The TemplateMatches in an image.\n\nRaises ValueError for an image that is not of this encoding.");
}

void bindTemplates(py::module& m)
{
  bindParams<TemplateParams>(m, "TemplateParams", "How templates are compared with images, and what is a result.");
  bindResponse(m);
  bindMatcher(m);
}

const Bindings kBindings("templates", {}, bindTemplates);

}  // namespace templates_bindings
