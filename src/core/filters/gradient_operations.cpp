#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "derivative_filter.hpp"
#include "operation_table.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/edges/edges.hpp"

using namespace std::string_literals;

namespace robot_vision
{

std::vector<Operation> gradientOperations()
{
  const OperationParam scale = {"scale", 1.0, Range{0.01, 100}, "", "factor on the derivative"};
  return {
      {"sobel",
       "The magnitude of a derivative: cv::Sobel, cv::convertScaleAbs.",
       kGrayOrColor,
       "",
       {{"dx", 1, Range{0, 2}, "", "order of the derivative in x"},
        {"dy", 0, Range{0, 2}, "", "order of the derivative in y"},
        {"size", 3, OddRange{1, 7}, "px", "side of the kernel"},
        scale},
       [](const OperationValues& v) -> Operation::Step
       {
         const Derivative derivative = {v.integer("dx"), v.integer("dy"), v.integer("size"), v.number("scale")};
         if (derivative.dx + derivative.dy == 0) throw std::invalid_argument("dx and dy are 0, one must be 1 or 2");
         if (derivative.size == 1 && derivative.dx == 2 && derivative.dy == 2)
           throw std::invalid_argument("size is 1, must be at least 3 for two second derivatives");
         return [derivative](const OperationInput& in, cv::Mat& out)
         { derivativeMagnitude(in.image, derivative, out); };
       }},
      {"scharr",
       "The magnitude of a first derivative that is the same in all directions: cv::Scharr, cv::convertScaleAbs.",
       kGrayOrColor,
       "",
       {{"direction", "x"s, OneOf{"x or y", "'"}, "", "of the derivative"}, scale},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const int dx = v.word("direction") == "x" ? 1 : 0;
             derivativeMagnitude(in.image, {dx, 1 - dx, cv::FILTER_SCHARR, v.number("scale")}, out);
           })},
      {"gradient",
       "How strong edges are, the mean of the magnitudes of the first derivatives in x and y: cv::Sobel, "
       "cv::convertScaleAbs, cv::addWeighted.",
       kGrayOrColor,
       "",
       {{"size", 3, OddRange{1, 7}, "px", "side of the kernel"}, scale},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             cv::Mat along_y;
             derivativeMagnitude(in.image, {1, 0, v.integer("size"), v.number("scale")}, out);
             derivativeMagnitude(in.image, {0, 1, v.integer("size"), v.number("scale")}, along_y);
             cv::addWeighted(out, 0.5, along_y, 0.5, 0.0, out);
           })},
      {"laplacian",
       "The magnitude of the sum of both second derivatives: cv::Laplacian, cv::convertScaleAbs.",
       kGrayOrColor,
       "",
       {{"size", 3, OddRange{1, 7}, "px", "side of the kernel"}, scale},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             cv::Mat derivative;
             cv::Laplacian(in.image, derivative, CV_16S, v.integer("size"), v.number("scale"));
             cv::convertScaleAbs(derivative, out);
           })},
      {"canny",
       "Thin edges, by the hysteresis of two thresholds: cv::Canny.",
       kGrayOnly,
       "",
       {{"low", 50.0, Range{0, 10000}, "", "gradient above which a pixel prolongs an edge"},
        {"high", 150.0, Range{0, 10000}, "", "gradient above which a pixel begins an edge; at least low"},
        {"aperture", 3, OddRange{3, 7}, "px", "side of the Sobel kernel"},
        {"l2_gradient", false, Anything{}, "", "Euclidean magnitude of the gradient"}},
       [](const OperationValues& v) -> Operation::Step
       {
         require(v.number("high") >= v.number("low"), "high", v.number("high"),
                 "at least low, " + toText(v.number("low")));
         EdgeParams params;
         params.blur_size = 1;
         params.low_threshold = v.number("low");
         params.high_threshold = v.number("high");
         params.aperture = v.integer("aperture");
         params.l2_gradient = v.flag("l2_gradient");
         const auto detector = std::make_shared<EdgeDetector>(params);
         return [detector](const OperationInput& in, cv::Mat& out) { detector->apply(in.image, in.encoding, out); };
       }},
  };
}

}  // namespace robot_vision
