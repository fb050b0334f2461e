#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "observed_frame.hpp"
#include "search_kernels.hpp"
#include "view_camera.hpp"
#include "view_templates.hpp"

namespace robot_vision
{

/// A pixel at which an object may be, as far away as its surface is there.
struct Place
{
  int x = 0, y = 0;
  float inverse = 0.0F;  // 1/m, of the depth
};

/// The frame whose z is a ray (x, y, 1): the shortest turn from the camera's axis brings it there.
cv::Matx33d rayFrame(double x, double y);

/// Pixels whose surfaces are about `step` (m) from each other, from min_inverse to max_inverse (1/m), within the mask
/// (CV_8UC1, of the frame's size; empty: anywhere). Where something may hide a surface that is seen within `reach` (m)
/// beside it, that is a place, too; where there are too few edges within `reach`, there is none.
std::vector<Place> findPlaces(const ObservedFrame& frame, const ViewCamera& camera, double step, double reach,
                              float min_inverse, float max_inverse, const cv::Mat& mask);

/// The same if all of the image is at this inverse depth.
std::vector<Place> placesAt(float inverse, const ObservedFrame& frame, const ViewCamera& camera, double step,
                            double reach, const cv::Mat& mask);

/// Which of kWindows is about as large as so many of the cells that are within `half_width` (m) of a place of this
/// inverse depth (1/m).
std::size_t windowAt(float inverse, const ViewCamera& camera, double half_width, double cells);

/// The planes of some places, for SearchKernels.
class PlacePlanes
{
public:
  /// Of places begin, ..., begin + count - 1, kPlacesAtOnce at most, with cells within `half_width` (m) of them.
  void prepare(const ObservedFrame& frame, const ViewCamera& camera, const Place* places, int count, double half_width);

  const std::uint8_t* planes() const { return planes_.data(); }

private:
  PlaceLanes lanes_;
  std::vector<std::uint8_t> planes_;
};

}  // namespace robot_vision
