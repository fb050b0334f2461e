#include "texture_places.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace robot_vision
{
namespace
{

constexpr double kPlaceSide = 4.0;     // px
constexpr double kObjectPlace = 0.01;  // of the diameter

}  // namespace

TexturePlace placeInImage(const TextureMatch& match)
{
  return {cvFloor(match.pixel.x / kPlaceSide), cvFloor(match.pixel.y / kPlaceSide), 0};
}

int countPlaces(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& chosen, double diameter)
{
  std::set<TexturePlace> in_image, on_object;
  for (const std::size_t i : chosen)
  {
    in_image.insert(placeInImage(matches[i]));
    const cv::Vec3d cell = matches[i].point * (1.0 / (kObjectPlace * diameter));
    on_object.insert({cvFloor(cell[0]), cvFloor(cell[1]), cvFloor(cell[2])});
  }
  return static_cast<int>(std::min(in_image.size(), on_object.size()));
}

PlaceSpread spreadOf(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& chosen)
{
  PlaceSpread spread;
  const double part = 1.0 / static_cast<double>(std::max(chosen.size(), std::size_t{1}));
  for (const std::size_t i : chosen)
    spread.mean += matches[i].point * part;
  cv::Matx33d covariance = cv::Matx33d::zeros();
  for (const std::size_t i : chosen)
  {
    const cv::Vec3d away = matches[i].point - spread.mean;
    covariance += away * away.t() * part;
  }
  cv::Vec3d variances;
  cv::Matx33d axes;
  cv::eigen(covariance, variances, axes);
  for (int i = 0; i < 3; ++i)
    spread.deviations[i] = std::sqrt(std::max(variances[i], 0.0));
  spread.normal = {axes(2, 0), axes(2, 1), axes(2, 2)};
  return spread;
}

}  // namespace robot_vision
