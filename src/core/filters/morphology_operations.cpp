#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/common/work_limit.hpp"
#include "operation_table.hpp"
#include "robot_vision/common/range.hpp"

using namespace std::string_literals;

namespace robot_vision
{
namespace
{

const std::map<std::string, int> kShapes = {
    {"rect", cv::MORPH_RECT}, {"cross", cv::MORPH_CROSS}, {"ellipse", cv::MORPH_ELLIPSE}};

constexpr double kMaxComparisons = 2e10;  // of bytes of an image: some seconds where a vector has 16 of them

/// How often cv::morphologyEx compares each value of an image with another. It does a rectangle in two passes, however
/// often it is to be done.
double comparisonsOf(int rule, const cv::Mat& element, int iterations)
{
  const int set = cv::countNonZero(element);
  const bool is_rect = set == element.rows * element.cols;
  const double once = is_rect ? 2.0 * (1 + iterations * (element.rows - 1)) : static_cast<double>(set) * iterations;
  return rule == cv::MORPH_ERODE || rule == cv::MORPH_DILATE ? once : 2.0 * once;
}

/// An operation that cv::morphologyEx has.
Operation morphology(const std::string& name, const std::string& meaning, int rule)
{
  const bool is_difference = rule == cv::MORPH_GRADIENT || rule == cv::MORPH_TOPHAT || rule == cv::MORPH_BLACKHAT;
  return {name,
          meaning + ": cv::morphologyEx.",
          is_difference ? kOpaque : kAllPixels,
          "",
          {{"shape", "rect"s, OneOf{"rect, cross or ellipse", "'"}, "", "of the structuring element"},
           {"size", 3, OddRange{1, 99}, "px", "side of the structuring element"},
           {"iterations", 1, Range{1, 20}, "", "how often it is done"}},
          [rule](const OperationValues& v) -> Operation::Step
          {
            const int size = v.integer("size");
            const int iterations = v.integer("iterations");
            const cv::Mat element = cv::getStructuringElement(v.choice("shape", kShapes), {size, size});
            const double comparisons = comparisonsOf(rule, element, iterations);
            return [=](const OperationInput& in, cv::Mat& out)
            {
              requireWork("size, iterations are " + toText(size) + ", " + toText(iterations),
                          comparisons * static_cast<double>(in.image.elemSize()), in.image.size(), kMaxComparisons);
              cv::morphologyEx(in.image, out, rule, element, {-1, -1}, iterations);
            };
          }};
}

/// The kernel of hit_or_miss. Throws std::invalid_argument for other numbers than 1, -1 and 0.
cv::Mat hitOrMissKernel(const std::string& rows)
{
  const cv::Mat kernel = parseKernel(rows);
  const auto is_sign = [](double number) { return number == 1.0 || number == -1.0 || number == 0.0; };
  if (!std::all_of(kernel.begin<double>(), kernel.end<double>(), is_sign))
    throw std::invalid_argument("rows must have the numbers 1, -1 and 0 only");
  cv::Mat signs;
  kernel.convertTo(signs, CV_32S);
  return signs;
}

}  // namespace

std::vector<Operation> morphologyOperations()
{
  return {
      morphology("erode", "The darkest pixel of a neighbourhood", cv::MORPH_ERODE),
      morphology("dilate", "The brightest pixel of a neighbourhood", cv::MORPH_DILATE),
      morphology("open", "Erosion and then dilation, which takes away small bright spots", cv::MORPH_OPEN),
      morphology("close", "Dilation and then erosion, which fills small dark holes", cv::MORPH_CLOSE),
      morphology("morphological_gradient", "Dilation less erosion, which leaves outlines", cv::MORPH_GRADIENT),
      morphology("top_hat", "What opening takes away", cv::MORPH_TOPHAT),
      morphology("black_hat", "What closing fills", cv::MORPH_BLACKHAT),
      {"hit_or_miss",
       "Where a pattern of set and unset pixels is: cv::morphologyEx.",
       kGrayOnly,
       "",
       {{"rows", "0 1 0; 1 -1 1; 0 1 0"s, Anything{}, "", "1: set, -1: not set, 0: either; rows with semicolons"}},
       [](const OperationValues& v) -> Operation::Step
       {
         return [kernel = hitOrMissKernel(v.word("rows"))](const OperationInput& in, cv::Mat& out)
         {
           requireWork("rows", cv::countNonZero(kernel), in.image.size(), kMaxComparisons);
           cv::morphologyEx(in.image, out, cv::MORPH_HITMISS, kernel);
         };
       }},
  };
}

}  // namespace robot_vision
