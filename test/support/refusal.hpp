#pragma once

#include <stdexcept>
#include <string>

/// The message of the error of this type that `function` throws; empty if it throws none.
template <class Error = std::invalid_argument, class Function>
std::string refusal(Function function)
{
  try
  {
    function();
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return "";
}

/// The refusal of parameters that have their defaults but for one.
template <class Params, class Field, class Value>
std::string refusalWith(Field Params::*field, const Value& value)
{
  Params params;
  params.*field = value;
  return refusal([&] { validate(params); });
}
