#include "robot_vision/common/range.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "robot_vision/common/printable.hpp"

namespace robot_vision
{
std::string toText(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string toText(const cv::Size& size)
{
  return sizeText(size.width, size.height);
}

std::string joined(const std::vector<std::string>& words)
{
  std::string list;
  for (const std::string& word : words)
    list += (list.empty() ? "" : ", ") + word;
  return list;
}

void require(bool ok, const std::string& name, const std::string& value, const std::string& expected)
{
  if (!ok) throw std::invalid_argument(name + " is " + shortened(value) + ", must be " + expected);
}

void require(bool ok, const std::string& name, double value, const std::string& expected)
{
  if (!ok) require(false, name, toText(value), expected);  // numbers are not written out for nothing
}

void requireRange(const std::string& name, double value, double low, double high)
{
  const bool ok = value >= low && value <= high;
  if (!ok) require(false, name, value, "from " + toText(low) + " to " + toText(high));
}

void requireFinite(const std::string& name, double value)
{
  require(std::isfinite(value), name, value, "finite");
}

}  // namespace robot_vision
