#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "mesh_parts.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinSize = 0.005, kMaxSize = 3.0;  // m
constexpr double kMinGuess = 0.02;                  // m, of what another unit would make of a mesh, to be named

struct KnownUnit
{
  const char* name;
  double metres;
};

constexpr std::array<KnownUnit, 4> kUnits = {{{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}}};

double longest(const cv::Vec3d& size)
{
  return std::max({size[0], size[1], size[2]});
}

/// A size with three digits of its longest side, such as 0.066 x 0.066 x 0.115 m.
std::string sizeWords(const cv::Vec3d& size, const char* unit)
{
  const double side = longest(size);
  const int decimals = side >= 100.0 ? 0 : side >= 10.0 ? 1 : side >= 1.0 ? 2 : side >= 0.1 ? 3 : 4;
  std::array<char, 160> text;
  std::snprintf(text.data(), text.size(), "%.*f x %.*f x %.*f %s", decimals, size[0], decimals, size[1], decimals,
                size[2], unit);
  return text.data();
}

bool isHandled(const cv::Vec3d& size)
{
  return longest(size) >= kMinSize && longest(size) <= kMaxSize;
}

/// Things that one can handle are from 3 cm to 3 m large if their numbers are above 3: then each number has one unit
/// that fits. Below that they are in m.
const KnownUnit& guess(const cv::Vec3d& size)
{
  const double side = longest(size), largest_in_m = 3.0, largest_in_cm = 30.0;
  return kUnits[side <= largest_in_m ? 0 : side <= largest_in_cm ? 1 : 2];
}

std::string guessWords(const KnownUnit& unit, const cv::Vec3d& size, double scale)
{
  const std::string numbers = scale == 1.0 ? "its numbers" : "its numbers times " + toText(scale);
  std::string words = numbers + " are " + sizeWords(size, "large") + ", which is taken for " + unit.name;
  std::string others;
  for (const KnownUnit& other : kUnits)
    if (other.name != unit.name && isHandled(size * other.metres) && longest(size) * other.metres >= kMinGuess)
      others += (others.empty() ? "" : ", ") + std::string(other.name) + " would make it " +
                sizeWords(size * other.metres, "m");
  return others.empty() ? words : words + " (" + others + ")";
}

}  // namespace

MeshUnit meshUnit(const std::string& named, bool is_metric, const cv::Vec3d& size, double scale)
{
  require(std::isfinite(scale) && scale > 0.0, "scale", scale, "positive");
  const auto known = std::find_if(kUnits.begin(), kUnits.end(), [&](const KnownUnit& u) { return u.name == named; });
  require(named.empty() || known != kUnits.end(), "unit", "'" + named + "'", "m, cm, mm or inch");
  const KnownUnit& unit = !named.empty() ? *known : is_metric ? kUnits[0] : guess(size * scale);
  const cv::Vec3d metres = size * scale * unit.metres;
  require(isHandled(metres), "its size",
          sizeWords(metres, "m") + (named.empty() && !is_metric ? "" : std::string(" in ") + unit.name),
          "from 0.005 to 3 m along its longest side; is its unit another one?");
  const std::string reason = !named.empty() ? "its unit is " + named + ", as was said"
                             : is_metric    ? "its unit is m, as files of its format say"
                                            : guessWords(unit, size * scale, scale);
  return {unit.name, unit.metres, reason + ": it is " + sizeWords(metres, "m")};
}

}  // namespace robot_vision
