#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "rendered_region.hpp"

namespace robot_vision
{

/// A point of an object where an image is expected to change.
struct ContourPoint
{
  cv::Vec3f point;   // m, from the center of the mesh, along the camera's axes
  cv::Vec2f normal;  // of length 1, across the contour in the image; away from the object if it is its outline
  bool is_outline;   // something else is seen on the other side
};

struct ContourLimits
{
  int outline = 200;  // points, at most
  int inner = 150;
};

/// Finds where the outline of what is drawn is, the creases where its normal turns suddenly, and where its colors
/// change, to a small part of a drawn pixel. Memory is kept from region to region. For one thread at a time.
class ContourPointFinder
{
public:
  /// The region must have normals, and colors if `texture`. The points are valid until the next call.
  const std::vector<ContourPoint>& find(const RenderedRegion& region, bool texture, const ContourLimits& limits);

  /// How many drawn pixels of contours there are for each point.
  double spacing() const { return spacing_; }

private:
  void findInside(const RenderedRegion& region);
  void addOutline(const RenderedRegion& region);
  void findCreases(const RenderedRegion& region);
  void findTexture(const RenderedRegion& region);
  void addRidges(const RenderedRegion& region, float min_strength);
  void keep(int count);

  std::vector<ContourPoint> points_, more_;
  double spacing_ = 1.0;
  cv::Mat mask_, smooth_;  // CV_32FC1, 1 where something is drawn; the same blurred
  cv::Mat inside_;         // CV_8UC1, 255 where all neighbours are of the same surface
  cv::Mat slopes_;         // CV_32FC2, along x and y, of what changes most
  cv::Mat strength_;       // CV_32FC1, their length
  cv::Mat gradients_;
};

}  // namespace robot_vision
