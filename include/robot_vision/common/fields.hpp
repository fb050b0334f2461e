#pragma once

#include <string>

namespace robot_vision
{

// A struct of parameters describes each of its fields once, where it is declared, in
//
//   template <class Visit>
//   static void fields(Visit&& visit);
//
// which calls visit(name, pointer to member, limits, unit, meaning) for one after the other. The default is the
// member's initializer. Checks, Python's attributes, dynamic_reconfigure and the parameter server all go by this
// description.

/// Limits of what may be anything, or has a rule that validate() knows.
struct Anything
{
};

/// A number from `low` to `high`.
struct Range
{
  double low;
  double high;
};

/// An odd number from `low` to `high`.
struct OddRange
{
  double low;
  double high;
};

/// A number above `low` and not above `high`; `words` are what a message has between the two.
struct Above
{
  double low;
  double high;
  const char* words = " and at most ";
};

/// One of `choices`, which are written as a message lists them: "3, 5 or 7". A message shows the value in `quote`s.
struct OneOf
{
  const char* choices;
  const char* quote = "";
};

/// The limits as messages and documents name them: "from 0 to 10". Empty for a value that may be anything.
std::string limitsText(const Anything& limits);
std::string limitsText(const Range& limits);
std::string limitsText(const OddRange& limits);
std::string limitsText(const Above& limits);
std::string limitsText(const OneOf& limits);

/// Throws std::invalid_argument naming the field, its value and the limits unless it is within them; NaN never is.
void checkField(const char* name, double value, const Range& limits);
void checkField(const char* name, double value, const OddRange& limits);
void checkField(const char* name, double value, const Above& limits);
void checkField(const char* name, double value, const OneOf& limits);
void checkField(const char* name, const std::string& value, const OneOf& limits);

template <class Value>
void checkField(const char* /*name*/, const Value& /*value*/, const Anything& /*limits*/)
{
}

/// Throws std::invalid_argument for the first field that is not within its limits.
template <class Params>
void checkFields(const Params& params)
{
  Params::fields([&params](const char* name, auto member, const auto& limits, const char* /*unit*/,
                           const char* /*meaning*/) { checkField(name, params.*member, limits); });
}

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range. A struct with rules
/// that concern several of its fields has an overload, declared beside it.
template <class Params>
void validate(const Params& params)
{
  checkFields(params);
}

/// Whether all fields of two structs are equal.
template <class Params>
bool equalFields(const Params& a, const Params& b)
{
  bool equal = true;
  Params::fields([&](const char* /*name*/, auto member, const auto& /*limits*/, const char* /*unit*/,
                     const char* /*meaning*/) { equal = equal && a.*member == b.*member; });
  return equal;
}

}  // namespace robot_vision
