#pragma once

#include <string>

namespace robot_vision
{

inline bool startsWith(const std::string& text, const std::string& start)
{
  return text.compare(0, start.size(), start) == 0;
}

}  // namespace robot_vision
