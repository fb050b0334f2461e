#include "robot_vision/filters/operations.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "operation_table.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxKernelSide = 31;

std::vector<Operation> allOperations()
{
  std::vector<Operation> all;
  for (auto make : {arithmeticOperations, blurOperations, colorOperations, geometryOperations, gradientOperations,
                    histogramOperations, morphologyOperations, pyramidOperations, thresholdOperations})
    for (Operation& operation : make())
      all.push_back(std::move(operation));
  std::sort(all.begin(), all.end(), [](const Operation& a, const Operation& b) { return a.name < b.name; });
  return all;
}

std::string fullName(const Operation& operation, const OperationParam& param)
{
  return operation.name + "_" + param.name;
}

/// `value` as the type that the parameter has; an integer may stand for a number with a fraction.
ParamValue converted(const std::string& name, const OperationParam& param, const ParamValue& value)
{
  if (value.index() == param.initial.index()) return value;
  if (const int* whole = std::get_if<int>(&value))
    if (std::holds_alternative<double>(param.initial)) return static_cast<double>(*whole);
  constexpr const char* kTypes[] = {"true or false", "an integer", "a number", "a text"};
  throw std::invalid_argument(name + " must be " + kTypes[param.initial.index()]);
}

void checkLimits(const std::string& name, const OperationParam& param, const ParamValue& value)
{
  const auto check = [&](const auto& limits, const auto& checked)
  {
    using Checked = std::decay_t<decltype(checked)>;
    if constexpr (std::is_same_v<std::decay_t<decltype(limits)>, OneOf> || !std::is_same_v<Checked, std::string>)
      checkField(name.c_str(), checked, limits);
  };
  std::visit(check, param.limits, value);
}

std::vector<double> numbersOf(const std::string& row)
{
  std::istringstream words(row);
  std::vector<double> numbers;
  for (std::string word; words >> word;)
  {
    std::size_t end = 0;
    try
    {
      numbers.push_back(std::stod(word, &end));
    }
    catch (const std::exception&)
    {
      end = 0;
    }
    if (end != word.size()) throw std::invalid_argument("'" + printable(word) + "' in rows is no number");
    requireFinite("a number in rows", numbers.back());
  }
  return numbers;
}

}  // namespace

const std::vector<Operation>& operations()
{
  static const std::vector<Operation> all = allOperations();
  return all;
}

const Operation& operationNamed(const std::string& name)
{
  std::vector<std::string> names;
  for (const Operation& operation : operations())
  {
    if (operation.name == name) return operation;
    names.push_back(operation.name);
  }
  throw std::invalid_argument("'" + printable(name) + "' is no operation, must be one of " + joined(names));
}

OperationValues completeValues(const Operation& operation, const ParamValues& values)
{
  ParamValues complete;
  for (const OperationParam& param : operation.params)
  {
    const std::string name = fullName(operation, param);
    const auto given = values.find(name);
    const ParamValue value = given == values.end() ? param.initial : converted(name, param, given->second);
    checkLimits(name, param, value);
    complete[param.name] = value;
  }
  return OperationValues(complete);
}

void checkValues(const ParamValues& values)
{
  std::set<std::string> known;
  for (const Operation& operation : operations())
  {
    for (const OperationParam& param : operation.params)
      known.insert(fullName(operation, param));
    completeValues(operation, values);
  }
  for (const auto& [name, value] : values)
    if (known.count(name) == 0) throw std::invalid_argument("'" + printable(name) + "' is no operation's parameter");
}

double grayLevel(const cv::Mat& image)
{
  return image.depth() == CV_16U ? 257.0 : 1.0;
}

cv::Mat parseKernel(const std::string& text)
{
  std::istringstream lines(text);
  cv::Mat kernel;
  for (std::string line; std::getline(lines, line, ';');)
  {
    const std::vector<double> numbers = numbersOf(line);
    if (numbers.empty() || numbers.size() > kMaxKernelSide || kernel.rows == static_cast<int>(kMaxKernelSide))
      throw std::invalid_argument("rows must be 1 to 31 rows of 1 to 31 numbers");
    if (!kernel.empty() && kernel.cols != static_cast<int>(numbers.size()))
      throw std::invalid_argument("rows must have the same number of numbers each");
    kernel.push_back(cv::Mat(numbers, true).reshape(1, 1));
  }
  if (kernel.empty()) throw std::invalid_argument("rows must be 1 to 31 rows of 1 to 31 numbers");
  return kernel;
}

void requireResultSize(const cv::Size& size, double scale)
{
  if (size.width * scale * size.height * scale <= static_cast<double>(kMaxPixels)) return;
  throw std::invalid_argument("the result would be " +
                              sizeText(std::llround(size.width * scale), std::llround(size.height * scale)) +
                              ", must have at most " + std::to_string(kMaxPixels) + " pixels");
}

}  // namespace robot_vision
