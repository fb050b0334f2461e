#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "box_filter.hpp"
#include "core/common/work_limit.hpp"
#include "gaussian_filter.hpp"
#include "median_filter.hpp"
#include "operation_table.hpp"
#include "robot_vision/common/range.hpp"

using namespace std::string_literals;

namespace robot_vision
{
namespace
{

constexpr double kMaxWeights = 4e9;     // of bilateral for an image, in colour some 0.5 ns each, shared by all cores
constexpr double kMaxPatchSteps = 1e9;  // for an image, in colour some 5 ns each, shared by all cores

/// How often nl_means compares a patch with another for each pixel. It does so anew where a row begins, and from there
/// on only with what is new in a patch.
double patchSteps(int patch_size, int search_size, int width)
{
  return static_cast<double>(search_size * search_size) * (1.0 + static_cast<double>(patch_size * patch_size) / width);
}

}  // namespace

std::vector<Operation> blurOperations()
{
  const OperationParam size = {"size", 5, OddRange{1, 255}, "px", "side of the square"};
  return {
      {"box",
       "The mean of a square around each pixel: cv::blur.",
       kAllPixels,
       "",
       {size},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { boxFilter(in.image, v.integer("size"), cv::BORDER_DEFAULT, out); })},
      {"gaussian",
       "A weighted mean that falls off with the distance: cv::GaussianBlur.",
       kAllPixels,
       "",
       {size, {"sigma", 0.0, Range{0, 100}, "px", "standard deviation; 0: as fits the size"}},
       [](const OperationValues& v) -> Operation::Step
       {
         return [filter = GaussianFilter(v.integer("size"), v.number("sigma"))](const OperationInput& in, cv::Mat& out)
         { filter.apply(in.image, out); };
       }},
      {"median",
       "The median of a square around each pixel, which takes away single wrong pixels: cv::medianBlur.",
       kEightBits,
       "",
       {size},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { medianFilter(in.image, v.integer("size"), out); })},
      {"bilateral",
       "A mean of pixels that are near and alike, which keeps edges: cv::bilateralFilter.",
       kGrayOrColor,
       "",
       {{"diameter", 9, Range{1, 31}, "px", "of the neighbourhood"},
        {"sigma_color", 75.0, Range{1, 255}, "gray levels", "how unlike pixels may be"},
        {"sigma_space", 75.0, Range{1, 255}, "px", "how far away they may be"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const int diameter = v.integer("diameter");
             requireWork("diameter is " + toText(diameter), diameter * diameter, in.image.size(), kMaxWeights);
             cv::bilateralFilter(in.image, out, diameter, v.number("sigma_color"), v.number("sigma_space"));
           })},
      {"nl_means",
       "A mean of patches that look alike: cv::fastNlMeansDenoising.",
       kEightBits,
       "",
       {{"strength", 3.0, Range{0.1, 100}, "gray levels", "of the noise to take away"},
        {"patch_size", 7, OddRange{3, 15}, "px", "side of the patches that are compared"},
        {"search_size", 21, OddRange{3, 41}, "px", "side of the square in which they are looked for"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const int patch = v.integer("patch_size");
             const int search = v.integer("search_size");
             requireWork("patch_size, search_size are " + toText(patch) + ", " + toText(search),
                         patchSteps(patch, search, in.image.cols), in.image.size(), kMaxPatchSteps);
             cv::fastNlMeansDenoising(in.image, out, static_cast<float>(v.number("strength")), patch, search);
           })},
      {"kernel",
       "A kernel of one's own: cv::filter2D.",
       kOpaque,
       "",
       {{"rows", "0 -1 0; -1 5 -1; 0 -1 0"s, Anything{}, "", "numbers with spaces between, rows with semicolons"},
        {"offset", 0.0, Range{-255, 255}, "gray levels", "added to the result"}},
       [](const OperationValues& v) -> Operation::Step
       {
         return [kernel = parseKernel(v.word("rows")), offset = v.number("offset")](const OperationInput& in,
                                                                                    cv::Mat& out) {
           cv::filter2D(in.image, out, -1, kernel, {-1, -1}, offset * grayLevel(in.image));
         };
       }},
      {"sharpen",
       "An unsharp mask: cv::addWeighted of the image and its cv::GaussianBlur.",
       kAllPixels,
       "",
       {{"amount", 1.0, Range{0, 10}, "", "of what the blur takes away, that is added"},
        {"sigma", 2.0, Range{0.3, 30}, "px", "of the blur"}},
       [](const OperationValues& v) -> Operation::Step
       {
         return [blur = GaussianFilter(0, v.number("sigma")), amount = v.number("amount")](const OperationInput& in,
                                                                                           cv::Mat& out)
         {
           cv::Mat blurred;
           blur.apply(in.image, blurred);
           cv::addWeighted(in.image, 1.0 + amount, blurred, -amount, 0.0, out);
         };
       }},
  };
}

}  // namespace robot_vision
