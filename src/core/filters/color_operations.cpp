#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/color/color_codes.hpp"
#include "core/color/range_mask.hpp"
#include "operation_table.hpp"
#include "robot_vision/common/range.hpp"

using namespace std::string_literals;

namespace robot_vision
{
namespace
{

const std::map<std::string, int> kFromBgr = {{"hsv", cv::COLOR_BGR2HSV},     {"hls", cv::COLOR_BGR2HLS},
                                             {"lab", cv::COLOR_BGR2Lab},     {"luv", cv::COLOR_BGR2Luv},
                                             {"ycrcb", cv::COLOR_BGR2YCrCb}, {"xyz", cv::COLOR_BGR2XYZ}};
constexpr OneOf kSpaces = {"hsv, hls, lab, luv, ycrcb or xyz", "'"};
constexpr OneOf kRangeSpaces = {"bgr, hsv, hls, lab, luv, ycrcb or xyz", "'"};

OperationParam bound(const std::string& name, int initial, const std::string& meaning)
{
  return {name, initial, Range{0, 255}, "", meaning};
}

Operation::Step makeColorRange(const OperationValues& v)
{
  const std::string space = v.word("space");
  const cv::Vec3i low(v.integer("low_1"), v.integer("low_2"), v.integer("low_3"));
  const cv::Vec3i high(v.integer("high_1"), v.integer("high_2"), v.integer("high_3"));
  const bool has_hues = space == "hsv" || space == "hls";
  const bool through_red = has_hues && low[0] > high[0];
  for (int i = through_red ? 1 : 0; i < 3; ++i)
  {
    const std::string number = std::to_string(i + 1);
    require(high[i] >= low[i], "high_" + number, high[i], "at least low_" + number + ", " + toText(low[i]));
  }
  const int code = space == "bgr" ? kNoColorCode : v.choice("space", kFromBgr);
  return [=](const OperationInput& in, cv::Mat& out)
  {
    cv::Mat converted, rest;
    if (code != kNoColorCode) cv::cvtColor(in.image, converted, code);
    findInRange(code == kNoColorCode ? in.image : converted, low, high, through_red, out, rest);
  };
}

}  // namespace

std::vector<Operation> colorOperations()
{
  return {
      {"gray",
       "The image in gray: cv::cvtColor.",
       {"mono8", "mono16"},
       "",
       {},
       eachTime([](const OperationValues&, const OperationInput& in, cv::Mat& out) { in.image.copyTo(out); })},
      {"color_space",
       "The three channels of another colour space, shown as blue, green and red: cv::cvtColor.",
       kBgrOnly,
       "",
       {{"space", "lab"s, kSpaces, "", "the colour space"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { cv::cvtColor(in.image, out, v.choice("space", kFromBgr)); })},
      {"color_range",
       "White where a colour is within a range, black elsewhere: cv::cvtColor, cv::inRange.",
       kBgrOnly,
       "mono8",
       {{"space", "hsv"s, kRangeSpaces, "", "the colour space whose channels are compared"},
        bound("low_1", 0, "least value of the first channel; of a hue above high_1: from there through red to high_1"),
        bound("low_2", 80, "least value of the second channel"),
        bound("low_3", 80, "least value of the third channel"),
        bound("high_1", 15, "largest value of the first channel"),
        bound("high_2", 255, "largest value of the second channel"),
        bound("high_3", 255, "largest value of the third channel")},
       makeColorRange},
      {"mask",
       "The other image, black where this one is: cv::bitwise_and with a mask.",
       kGrayOnly,
       "bgr8",
       {},
       eachTime(
           [](const OperationValues&, const OperationInput& in, cv::Mat& out)
           {
             out.create(in.image.size(), CV_8UC3);
             out = cv::Scalar::all(0);
             in.second.copyTo(out, in.image);
           }),
       "bgr8"},
      {"alpha",
       "A channel of opacity is added, or set: cv::cvtColor.",
       {"bgr8", "bgra8"},
       "bgra8",
       {{"value", 255, Range{0, 255}, "", "opacity; 255 is opaque"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             out.create(in.image.size(), CV_8UC4);
             if (in.image.channels() == 4)
               in.image.copyTo(out);
             else
               cv::cvtColor(in.image, out, cv::COLOR_BGR2BGRA);
             cv::insertChannel(cv::Mat(out.size(), CV_8UC1, cv::Scalar(v.integer("value"))), out, 3);
           })},
  };
}

}  // namespace robot_vision
