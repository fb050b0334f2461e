#include <opencv2/imgproc.hpp>

#include "adaptive_threshold.hpp"
#include "operation_table.hpp"

using namespace std::string_literals;

namespace robot_vision
{
namespace
{

const std::map<std::string, int> kKinds = {{"binary", cv::THRESH_BINARY},
                                           {"binary_inv", cv::THRESH_BINARY_INV},
                                           {"trunc", cv::THRESH_TRUNC},
                                           {"tozero", cv::THRESH_TOZERO},
                                           {"tozero_inv", cv::THRESH_TOZERO_INV}};
const std::map<std::string, int> kMethods = {
    {"fixed", 0}, {"otsu", cv::THRESH_OTSU}, {"triangle", cv::THRESH_TRIANGLE}};

}  // namespace

std::vector<Operation> thresholdOperations()
{
  return {
      {"threshold",
       "Pixels above and below a value: cv::threshold.",
       kGrayOnly,
       "",
       {{"method", "fixed"s, OneOf{"fixed, otsu or triangle", "'"}, "", "how the value is found"},
        {"value", 127.0, Range{0, 255}, "gray levels", "with the method fixed"},
        {"kind", "binary"s, OneOf{"binary, binary_inv, trunc, tozero or tozero_inv", "'"}, "",
         "what becomes of the pixels"},
        {"max", 255.0, Range{0, 255}, "gray levels", "what binary kinds set"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             cv::threshold(in.image, out, v.number("value"), v.number("max"),
                           v.choice("kind", kKinds) | v.choice("method", kMethods));
           })},
      {"adaptive_threshold",
       "Pixels brighter than their neighbourhood: cv::adaptiveThreshold.",
       kGrayOnly,
       "",
       {{"mean", "gaussian"s, OneOf{"mean or gaussian", "'"}, "", "which mean of the neighbourhood"},
        {"size", 11, OddRange{3, 255}, "px", "side of the neighbourhood"},
        {"offset", 2.0, Range{-255, 255}, "gray levels", "taken from the mean"},
        {"inverse", false, Anything{}, "", "whether the darker pixels are set"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             if (v.word("mean") == "mean")
               return adaptiveMeanThreshold(in.image, v.integer("size"), v.number("offset"), v.flag("inverse"), out);
             cv::adaptiveThreshold(in.image, out, 255.0, cv::ADAPTIVE_THRESH_GAUSSIAN_C,
                                   v.flag("inverse") ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY, v.integer("size"),
                                   v.number("offset"));
           })},
  };
}

}  // namespace robot_vision
