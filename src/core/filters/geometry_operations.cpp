#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/image/rects.hpp"
#include "operation_table.hpp"

using namespace std::string_literals;

namespace robot_vision
{
namespace
{

const std::map<std::string, int> kInterpolations = {{"nearest", cv::INTER_NEAREST},
                                                    {"linear", cv::INTER_LINEAR},
                                                    {"cubic", cv::INTER_CUBIC},
                                                    {"area", cv::INTER_AREA},
                                                    {"lanczos4", cv::INTER_LANCZOS4}};
const std::map<std::string, int> kAxes = {{"vertical", 1}, {"horizontal", 0}, {"both", -1}};
constexpr std::array<const char*, 8> kCorners = {"x1", "y1", "x2", "y2", "x3", "y3", "x4", "y4"};

/// The four corners of `values`, in px of an image of `size`: upper left, upper right, lower right, lower left.
std::array<cv::Point2f, 4> cornersIn(const cv::Size& size, const OperationValues& values)
{
  std::array<cv::Point2f, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = {static_cast<float>(values.number(kCorners[2 * i]) * (size.width - 1)),
                  static_cast<float>(values.number(kCorners[2 * i + 1]) * (size.height - 1))};
  return corners;
}

OperationParam corner(const std::string& name, double initial, const std::string& meaning)
{
  return {name, initial, Range{-1, 2}, "", meaning + ", as a share of the image"};
}

}  // namespace

std::vector<Operation> geometryOperations()
{
  return {
      {"resize",
       "The image in another size: cv::resize.",
       kAllPixels,
       "",
       {{"scale", 0.5, Range{0.05, 8}, "", "factor on width and height"},
        {"interpolation", "linear"s, OneOf{"nearest, linear, cubic, area or lanczos4", "'"}, "",
         "how values between pixels are found"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             requireResultSize(in.image.size(), v.number("scale"));
             cv::resize(in.image, out, scaledSize(in.image.size(), v.number("scale")), 0.0, 0.0,
                        v.choice("interpolation", kInterpolations));
           })},
      {"flip",
       "The image in a mirror: cv::flip.",
       kAllPixels,
       "",
       {{"axis", "vertical"s, OneOf{"vertical, horizontal or both", "'"}, "", "of the mirror"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { cv::flip(in.image, out, v.choice("axis", kAxes)); })},
      {"rotate",
       "The image turned about its middle: cv::getRotationMatrix2D, cv::warpAffine.",
       kAllPixels,
       "",
       {{"angle", 45.0, Range{-360, 360}, "degrees", "counter-clockwise"},
        {"scale", 1.0, Range{0.1, 10}, "", "factor on the size"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const cv::Point2f middle((in.image.cols - 1) / 2.0F, (in.image.rows - 1) / 2.0F);
             cv::warpAffine(in.image, out, cv::getRotationMatrix2D(middle, v.number("angle"), v.number("scale")),
                            in.image.size());
           })},
      {"affine",
       "The image shifted and sheared: cv::warpAffine.",
       kAllPixels,
       "",
       {{"x", 0.0, Range{-10000, 10000}, "px", "shift to the right"},
        {"y", 0.0, Range{-10000, 10000}, "px", "shift down"},
        {"shear_x", 0.3, Range{-5, 5}, "", "shift to the right for each row"},
        {"shear_y", 0.0, Range{-5, 5}, "", "shift down for each column"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const cv::Matx23d matrix(1.0, v.number("shear_x"), v.number("x"), v.number("shear_y"), 1.0, v.number("y"));
             cv::warpAffine(in.image, out, matrix, in.image.size());
           })},
      {"perspective",
       "Four points become the corners of the image: cv::getPerspectiveTransform, cv::warpPerspective.",
       kAllPixels,
       "",
       {corner("x1", 0.25, "upper left point"), corner("y1", 0.25, "upper left point"),
        corner("x2", 0.75, "upper right point"), corner("y2", 0.25, "upper right point"),
        corner("x3", 1.0, "lower right point"), corner("y3", 1.0, "lower right point"),
        corner("x4", 0.0, "lower left point"), corner("y4", 1.0, "lower left point")},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const auto right = static_cast<float>(in.image.cols - 1);
             const auto bottom = static_cast<float>(in.image.rows - 1);
             const std::array<cv::Point2f, 4> corners = {{{0, 0}, {right, 0}, {right, bottom}, {0, bottom}}};
             const cv::Mat matrix = cv::getPerspectiveTransform(cornersIn(in.image.size(), v).data(), corners.data());
             cv::warpPerspective(in.image, out, matrix, in.image.size());
           })},
      {"polar",
       "Angles as rows, distances from the middle as columns: cv::warpPolar.",
       kAllPixels,
       "",
       {{"log", false, Anything{}, "", "whether the columns are logarithms of the distance"},
        {"inverse", false, Anything{}, "", "whether rows and columns become angles and distances"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const cv::Point2f middle((in.image.cols - 1) / 2.0F, (in.image.rows - 1) / 2.0F);
             const double radius = std::max(1.0, std::hypot(double{middle.x}, double{middle.y}));
             const int log = v.flag("log") ? cv::WARP_POLAR_LOG : cv::WARP_POLAR_LINEAR;
             const int inverse = v.flag("inverse") ? cv::WARP_INVERSE_MAP : 0;
             cv::warpPolar(in.image, out, in.image.size(), middle, radius,
                           cv::INTER_LINEAR | cv::WARP_FILL_OUTLIERS | log | inverse);
           })},
  };
}

}  // namespace robot_vision
