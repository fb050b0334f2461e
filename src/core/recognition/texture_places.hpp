#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "texture_match.hpp"

namespace robot_vision
{

/// A cell of a grid in the image or on an object; keypoints of several levels of a pyramid are often in the same one.
using TexturePlace = std::array<int, 3>;

TexturePlace placeInImage(const TextureMatch& match);

/// The number of different places that matches are at: in the image or on the object, whichever are fewer. `diameter`
/// (m) is that of the object.
int countPlaces(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& chosen, double diameter);

/// How the points of matches are spread on the object.
struct PlaceSpread
{
  cv::Vec3d mean;        // m
  cv::Vec3d deviations;  // m, standard deviations along the axes of their ellipsoid, the largest first
  cv::Vec3d normal;      // of length 1, along the shortest axis
};

PlaceSpread spreadOf(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& chosen);

}  // namespace robot_vision
