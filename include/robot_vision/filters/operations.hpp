#pragma once

#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// A value of a parameter of an operation.
using ParamValue = std::variant<bool, int, double, std::string>;

/// Values by the parameters' names.
using ParamValues = std::map<std::string, ParamValue>;

/// A parameter of an operation. Its type is that of its default.
struct OperationParam
{
  std::string name;
  ParamValue initial;
  std::variant<Anything, Range, OddRange, Above, OneOf> limits;
  std::string unit;
  std::string meaning;
};

/// Values of all parameters of one operation, checked, by the parameters' own names ("size").
class OperationValues
{
public:
  explicit OperationValues(ParamValues values) : values_(std::move(values)) {}

  bool flag(const std::string& name) const { return std::get<bool>(values_.at(name)); }
  int integer(const std::string& name) const { return std::get<int>(values_.at(name)); }
  double number(const std::string& name) const { return std::get<double>(values_.at(name)); }
  const std::string& word(const std::string& name) const { return std::get<std::string>(values_.at(name)); }

  /// What the word of a parameter stands for, mostly a constant of OpenCV. `meanings` has all that its limits allow.
  int choice(const std::string& name, const std::map<std::string, int>& meanings) const
  {
    return meanings.at(word(name));
  }

private:
  ParamValues values_;
};

/// An image on its way through an operation.
struct OperationInput
{
  const cv::Mat& image;         // what the operation before has made, in an encoding that this one takes
  const std::string& encoding;  // of `image`
  const cv::Mat& second;        // of the same size, in the encoding that the operation says; empty if it needs none
};

/// An operation on images. It gives what OpenCV's functions give, to the bit.
struct Operation
{
  /// Writes the result for one image; it may keep buffers for the next.
  using Step = std::function<void(const OperationInput& input, cv::Mat& out)>;

  std::string name;
  std::string meaning;                 // a sentence that names OpenCV's function
  std::vector<std::string> encodings;  // that it takes; others are converted to one of bgr8 and mono8
  std::string output;                  // the encoding of its results; empty: that of its input
  std::vector<OperationParam> params;
  std::function<Step(const OperationValues& values)> make;
  std::string second = {};  // the encoding of a second image that it takes; "input": that of the first
};

/// All operations, ordered by name.
const std::vector<Operation>& operations();

/// The operation of that name. Throws std::invalid_argument that lists those that there are.
const Operation& operationNamed(const std::string& name);

/// Values of all of an operation's parameters: those in `values`, which go by the operation's name, an underscore and
/// their own ("gaussian_size"), or else the defaults. Throws std::invalid_argument naming operation, parameter, value
/// and what was expected for one of another type or out of its range.
OperationValues completeValues(const Operation& operation, const ParamValues& values);

/// Throws std::invalid_argument as completeValues() does for any operation, and for names that are no operation's
/// parameters.
void checkValues(const ParamValues& values);

}  // namespace robot_vision
