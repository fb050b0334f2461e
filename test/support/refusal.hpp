#pragma once

#include <stdexcept>
#include <string>

/// What the std::invalid_argument says that `function` throws; empty if it throws none.
template <class Function>
std::string refusal(Function function)
{
  try
  {
    function();
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return "";
}
