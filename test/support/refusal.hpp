#pragma once

#include <stdexcept>
#include <string>

/// The message of the std::invalid_argument that `function` throws; empty if it throws none.
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
