#include "robot_vision/common/fields.hpp"

#include <cmath>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

/// Whether the list "a, b or c" has the word.
bool lists(const std::string& choices, const std::string& word)
{
  if (word.find(',') != std::string::npos) return false;
  std::string words = choices;
  const std::size_t last = words.rfind(" or ");
  if (last != std::string::npos) words.replace(last, 4, ", ");
  return (", " + words + ", ").find(", " + word + ", ") != std::string::npos;
}

}  // namespace

std::string limitsText(const Anything& /*limits*/)
{
  return "";
}

std::string limitsText(const Range& limits)
{
  return "from " + toText(limits.low) + " to " + toText(limits.high);
}

std::string limitsText(const OddRange& limits)
{
  return "odd and from " + toText(limits.low) + " to " + toText(limits.high);
}

std::string limitsText(const Above& limits)
{
  return "above " + toText(limits.low) + limits.words + toText(limits.high);
}

std::string limitsText(const OneOf& limits)
{
  return limits.choices;
}

void checkField(const char* name, double value, const Range& limits)
{
  requireRange(name, value, limits.low, limits.high);
}

void checkField(const char* name, double value, const OddRange& limits)
{
  const bool odd = std::fmod(std::abs(value), 2.0) == 1.0;
  require(odd && value >= limits.low && value <= limits.high, name, value, limitsText(limits));
}

void checkField(const char* name, double value, const Above& limits)
{
  require(value > limits.low && value <= limits.high, name, value, limitsText(limits));
}

void checkField(const char* name, double value, const OneOf& limits)
{
  checkField(name, toText(value), limits);
}

void checkField(const char* name, const std::string& value, const OneOf& limits)
{
  require(lists(limits.choices, value), name, limits.quote + value + limits.quote, limits.choices);
}

}  // namespace robot_vision
