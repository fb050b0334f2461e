#include <pybind11/stl.h>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/overlay.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace image_bindings
{

using Color = std::array<double, 3>;

std::vector<cv::Point2d> toCenters(const Matrix& centers)
{
  if (centers.size() == 0) return {};
  if (centers.ndim() != 2 || centers.shape(1) != 2) throw py::value_error("expected an (n, 2) array of centres");
  const auto* points = reinterpret_cast<const cv::Point2d*>(centers.data());
  return {points, points + centers.shape(0)};
}

void bindConversions(py::module& m)
{
  m.def("encodings", &encodings, "The pixel layouts that are known, named as in sensor_msgs/image_encodings.");
  m.def(
      "to_gray",
      [](const py::array& image, const std::string& encoding)
      {
        const ImageArray input(image);
        cv::Mat gray;
        {
          const LeaveGil unlocked;
          toGray(input.view, encoding, gray);
        }
        if (!sharesPixels(gray, input.view)) return toPython(gray);
        py::array view = toPython(gray, input.array);
        view.attr("setflags")("write"_a = false);
        return view;
      },
      "image"_a, "encoding"_a,
      "Gray image, (height, width); a read-only view of the input where that is gray.\n\n"
      "Raises ValueError for an image that is not of this encoding.");
  m.def(
      "to_bgr",
      [](const py::array& image, const std::string& encoding)
      {
        const ImageArray input(image);
        return imageFrom(
            [&](cv::Mat& bgr)
            {
              toBgr(input.view, encoding, bgr);
              if (sharesPixels(bgr, input.view)) bgr = bgr.clone();
            });
      },
      "image"_a, "encoding"_a,
      "A new (height, width, 3) image, to draw on, of one of any encoding.\n\n"
      "Raises ValueError for an image that is not of this encoding.");
}

void bindOverlay(py::module& m)
{
  m.def(
      "mask_picture",
      [](const py::array& bgr, const py::array& mask)
      {
        const ImageArray image(bgr), where(mask);
        return imageFrom([&](cv::Mat& out) { maskPicture(image.view, where.view, out); });
      },
      "bgr"_a, "mask"_a,
      "The (height, width, 3) image where the (height, width) mask is not 0, black elsewhere.\n\n"
      "Raises ValueError for what is no image, and no mask of its size.");
  m.def(
      "draw_outline",
      [](const py::array& bgr, const py::object& outline, const std::string& label, const Color& color)
      {
        cv::Mat image = canvas(bgr);
        const std::vector<cv::Point> polygon = toPoints(outline);
        const LeaveGil unlocked;
        drawOutline(image, polygon, label, {color[0], color[1], color[2]});
      },
      "bgr"_a, "outline"_a, "label"_a = "", "color"_a = Color{0, 255, 0},
      "Draws a closed polygon, (n, 2) int px, with a label (ASCII) on the image, (height, width, 3) uint8.\n\n"
      "Raises ValueError for an array that cannot be drawn on.");
  m.def(
      "draw_text",
      [](const py::array& bgr, const std::string& text, const std::pair<int, int>& position, const Color& color)
      {
        cv::Mat image = canvas(bgr);
        const LeaveGil unlocked;
        drawText(image, text, {position.first, position.second}, {color[0], color[1], color[2]});
      },
      "bgr"_a, "text"_a, "position"_a, "color"_a = Color{0, 255, 0},
      "Writes a line of text (ASCII) on the image, (height, width, 3) uint8, from the left end of its base line, "
      "px.\n\n"
      "Raises ValueError for an array that cannot be drawn on.");
  m.def(
      "draw_dot",
      [](const py::array& bgr, const std::pair<double, double>& center, double radius, const Color& color)
      {
        cv::Mat image = canvas(bgr);
        const LeaveGil unlocked;
        drawDot(image, {center.first, center.second}, radius, {color[0], color[1], color[2]});
      },
      "bgr"_a, "center"_a, "radius"_a, "color"_a = Color{0, 255, 0},
      "Draws a filled circle on the image, (height, width, 3) uint8: center (x, y) and radius in px.\n\n"
      "Raises ValueError for an array that cannot be drawn on.");
  m.def(
      "draw_ball",
      [](const py::array& bgr, const std::pair<double, double>& center, double radius, bool predicted)
      {
        cv::Mat image = canvas(bgr);
        const LeaveGil unlocked;
        drawBall(image, {center.first, center.second}, radius, predicted);
      },
      "bgr"_a, "center"_a, "radius"_a, "predicted"_a = false,
      "Draws a ball on the image, (height, width, 3) uint8: center (x, y) and radius in px; dashed if predicted.\n\n"
      "Raises ValueError for an array that cannot be drawn on.");
  m.def(
      "draw_trail",
      [](const py::array& bgr, const Matrix& centers)
      {
        cv::Mat image = canvas(bgr);
        const std::vector<cv::Point2d> points = toCenters(centers);
        const LeaveGil unlocked;
        drawTrail(image, points);
      },
      "bgr"_a, "centers"_a,
      "Draws the way through centres, (n, 2) px, the newest last, on the image, (height, width, 3) uint8; NaN "
      "interrupts it.\n\n"
      "Raises ValueError for an array that cannot be drawn on.");
}

void bindImage(py::module& m)
{
  bindConversions(m);
  bindOverlay(m);
}

const Bindings kBindings("image", {}, bindImage);

}  // namespace image_bindings
