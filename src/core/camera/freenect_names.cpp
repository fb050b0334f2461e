#include "freenect_names.hpp"

#include <algorithm>
#include <cctype>

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxDigits = 2;  // of a number in a list; serial numbers are longer

bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

}  // namespace

/// libfreenect has its errors from libusb, by name or by number.
std::string freenectAdvice(const std::string& log)
{
  if (contains(log, "ERROR_ACCESS") || contains(log, ": -3"))
    return "; libfreenect's udev rule gives it to the group plugdev: join with `sudo usermod -aG plugdev $USER`, "
           "log in again, and plug it in again";
  if (contains(log, "ERROR_BUSY") || contains(log, ": -6")) return "; another program uses it";
  return "";
}

int freenectIndex(const std::string& name)
{
  const bool from_one = !name.empty() && name.front() == '#';
  const std::string digits = name.empty() ? "0" : name.substr(from_one ? 1 : 0);
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  if (digits.empty() || digits.size() > kMaxDigits || !std::all_of(digits.begin(), digits.end(), is_digit)) return -1;
  return std::stoi(digits) - (from_one ? 1 : 0);
}

}  // namespace robot_vision
