#include <stdexcept>

#include "core/common/starts_with.hpp"
#include "operation_table.hpp"
#include "robot_vision/common/range.hpp"

using namespace std::string_literals;

namespace robot_vision
{
namespace
{

/// The rectangle of `values` in an image. Throws std::invalid_argument if it has no pixel there.
cv::Rect roiIn(const cv::Size& size, const OperationValues& values)
{
  const cv::Rect image({}, size);
  const int x = values.integer("x");
  const int y = values.integer("y");
  const int width = values.integer("width") > 0 ? values.integer("width") : size.width;
  const int height = values.integer("height") > 0 ? values.integer("height") : size.height;
  const cv::Rect roi = cv::Rect(x, y, width, height) & image;
  if (roi.empty())
    throw std::invalid_argument("x, y are " + toText(x) + ", " + toText(y) + ", must be inside of the image of " +
                                toText(size));
  return roi;
}

void combineBits(const std::string& rule, const cv::Mat& a, const cv::Mat& b, cv::Mat& out)
{
  if (rule == "and")
    cv::bitwise_and(a, b, out);
  else if (rule == "or")
    cv::bitwise_or(a, b, out);
  else
    cv::bitwise_xor(a, b, out);
}

/// The channels of bgr8 or rgb8 by their names.
int channelIndex(const std::string& color, const std::string& encoding)
{
  const int index = color == "blue" ? 0 : color == "green" ? 1 : 2;
  return startsWith(encoding, "rgb") ? 2 - index : index;
}

}  // namespace

std::vector<Operation> arithmeticOperations()
{
  return {
      {"add",
       "A value is added to every channel: cv::add.",
       kOpaque,
       "",
       {{"value", 50.0, Range{-255, 255}, "gray levels", "that is added"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { cv::add(in.image, cv::Scalar::all(v.number("value") * grayLevel(in.image)), out); })},
      {"blend",
       "A weighted sum with the other image: cv::addWeighted.",
       kAllPixels,
       "",
       {{"weight", 0.5, Range{0, 1}, "", "of this image; the other one has the rest"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { cv::addWeighted(in.image, v.number("weight"), in.second, 1.0 - v.number("weight"), 0.0, out); }),
       "input"},
      {"bitwise",
       "The bits of this image and of the other one: cv::bitwise_and, cv::bitwise_or, cv::bitwise_xor.",
       kOpaque,
       "",
       {{"rule", "and"s, OneOf{"and, or or xor", "'"}, "", "which bits are set"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { combineBits(v.word("rule"), in.image, in.second, out); }),
       "input"},
      {"channel",
       "One channel of a colour image, in gray: cv::extractChannel.",
       kColors,
       "mono8",
       {{"color", "green"s, OneOf{"blue, green or red", "'"}, "", "which channel"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { cv::extractChannel(in.image, out, channelIndex(v.word("color"), in.encoding)); })},
      {"channels",
       "A colour image is split and merged again with only some of its channels: cv::split, cv::merge.",
       kColors,
       "",
       {{"blue", true, Anything{}, "", "whether blue stays"},
        {"green", false, Anything{}, "", "whether green stays"},
        {"red", false, Anything{}, "", "whether red stays"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             cv::Scalar factors = cv::Scalar::all(1.0);
             for (const char* color : {"blue", "green", "red"})
               factors[channelIndex(color, in.encoding)] = v.flag(color) ? 1.0 : 0.0;
             cv::multiply(in.image, factors, out);
           })},
      {"difference",
       "How far this image is from the other one: cv::absdiff.",
       kOpaque,
       "",
       {},
       eachTime([](const OperationValues&, const OperationInput& in, cv::Mat& out)
                { cv::absdiff(in.image, in.second, out); }),
       "input"},
      {"invert",
       "The negative: cv::bitwise_not.",
       kOpaque,
       "",
       {},
       eachTime([](const OperationValues&, const OperationInput& in, cv::Mat& out)
                { cv::bitwise_not(in.image, out); })},
      {"roi",
       "A part of the image.",
       kAllPixels,
       "",
       {{"x", 0, Range{0, 100000}, "px", "left side"},
        {"y", 0, Range{0, 100000}, "px", "upper side"},
        {"width", 0, Range{0, 100000}, "px", "0: up to the right side of the image"},
        {"height", 0, Range{0, 100000}, "px", "0: down to its lower side"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { in.image(roiIn(in.image.size(), v)).copyTo(out); })},
  };
}

}  // namespace robot_vision
