#include "output_shapes.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

std::string shapeText(const std::vector<std::int64_t>& shape)
{
  std::vector<std::string> lengths;
  for (const std::int64_t length : shape)
    lengths.push_back(length == HeadOutputs::kAny ? "n" : std::to_string(length));
  return "(" + joined(lengths) + ")";
}

}  // namespace

HeadOutputs::HeadOutputs(std::string head, const std::vector<NetworkOutput>& outputs)
  : head_(std::move(head)), outputs_(outputs)
{
}

void HeadOutputs::requireCount(std::size_t count) const
{
  if (outputs_.size() != count)
    throw std::invalid_argument(head_ + " has " + std::to_string(outputs_.size()) + " outputs, must have " +
                                std::to_string(count));
}

std::vector<std::int64_t> HeadOutputs::lastAxes(std::size_t output, std::size_t axes) const
{
  const std::vector<std::int64_t>& shape = outputs_[output].shape;
  if (shape.size() < axes) return {};
  const auto first = shape.end() - static_cast<std::ptrdiff_t>(axes);
  if (std::any_of(shape.begin(), first, [](std::int64_t length) { return length != 1; })) return {};
  return {first, shape.end()};
}

OutputRows HeadOutputs::rows(std::size_t output, const std::vector<std::int64_t>& shape) const
{
  const std::vector<std::int64_t> seen = lastAxes(output, shape.size());
  bool fits = seen.size() == shape.size();
  std::size_t columns = 1;
  for (std::size_t i = 0; fits && i < shape.size(); ++i)
  {
    fits = shape[i] == kAny || shape[i] == seen[i];
    if (i > 0) columns *= static_cast<std::size_t>(seen[i]);
  }
  if (!fits)
  {
    std::vector<std::int64_t> expected = {1};
    expected.insert(expected.end(), shape.begin(), shape.end());
    refuse(output, shapeText(expected));
  }
  return {outputs_[output].values, static_cast<std::size_t>(seen[0]), columns};
}

void HeadOutputs::refuse(std::size_t output, const std::string& expected) const
{
  throw std::invalid_argument(head_ + ": output " + std::to_string(output) + " is of shape " +
                              shapeText(outputs_[output].shape) + ", must be of " + expected);
}

}  // namespace robot_vision
