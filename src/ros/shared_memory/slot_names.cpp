#include "slot_names.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>

namespace robot_vision
{
namespace
{

constexpr char kPrefix[] = "robot_vision/";
constexpr std::size_t kPrefixLength = sizeof(kPrefix) - 1;
constexpr std::size_t kDigits = 32;

bool isDigit(char character)
{
  return (character >= '0' && character <= '9') || (character >= 'a' && character <= 'f');
}

}  // namespace

std::string slotSocketName(std::uint64_t high, std::uint64_t low)
{
  std::array<char, kDigits + 1> digits{};
  std::snprintf(digits.data(), digits.size(), "%016" PRIx64 "%016" PRIx64, high, low);
  return kPrefix + std::string(digits.data());
}

bool isSlotSocketName(const std::string& name)
{
  return name.size() == kPrefixLength + kDigits && name.compare(0, kPrefixLength, kPrefix) == 0 &&
         std::all_of(name.begin() + kPrefixLength, name.end(), isDigit);
}

}  // namespace robot_vision
