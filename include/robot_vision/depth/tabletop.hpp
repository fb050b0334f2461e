#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/depth/planes.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

struct TabletopParams
{
  double up_tolerance = 15.0;
  double min_table_area = 0.1;
  double min_height = 0.01;
  double max_height = 0.6;
  double margin = 0.02;
  double gap = 0.03;
  int min_pixels = 100;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("up_tolerance", &TabletopParams::up_tolerance, Range{0.1, 90}, "deg",
          "largest angle between the normal of a table and what is up");
    visit("min_table_area", &TabletopParams::min_table_area, Range{0, 1000}, "m^2",
          "of the hull of a table; smaller ones are tops of objects");
    visit("min_height", &TabletopParams::min_height, Range{0, 10}, "m",
          "of objects above their table, and three standard deviations of the noise at least");
    visit("max_height", &TabletopParams::max_height, Range{0.001, 10}, "m", "likewise; what is higher is left out");
    visit("margin", &TabletopParams::margin, Range{0, 1}, "m",
          "by which objects may be beyond the hull of their table");
    visit("gap", &TabletopParams::gap, Range{0.0001, 1}, "m",
          "largest difference of depth between neighbouring pixels of one object");
    visit("min_pixels", &TabletopParams::min_pixels, Range{1, 1000000}, "px^2",
          "smallest object; smaller ones are left out");
  }
};

/// Throws std::invalid_argument for the first parameter out of range, and for a max_height not above min_height.
void validate(const TabletopParams& params);

/// Something that stands on a table, as far as it is seen.
struct TableObject
{
  cv::Rect box;       // px
  int pixels = 0;     // that show it
  cv::Affine3d pose;  // of the box around it in the camera's optical frame, m: the origin is the middle of the box, z
                      // is the table's normal, x is along the longer side of its footprint, the smallest rectangle, to
                      // the camera's right
  cv::Vec3d size;     // m, of the box; z is from the table to the top
};

struct Table
{
  Plane plane;
  cv::Affine3d pose;  // in the camera's optical frame, m: the origin is the middle of the smallest rectangle around its
                      // hull, x is along the longer side of that, to the camera's right, z is the normal
  cv::Vec2d size;     // m, of that rectangle
  std::vector<TableObject> objects;  // the one with most pixels first
};

struct Tabletop
{
  std::vector<Table> tables;  // the highest first: nearest to the camera along the normal
  cv::Mat labels;  // CV_16UC1: 1 for pixels of the first object of all tables, 2 of the second, ...; 0 of none
};

/// Finds tables in the depth images of one camera, and what stands on them: pixels above the hull of a table that hang
/// together. Walls that a table ends at do not stand on it. Memory is kept from frame to frame. For one thread at a
/// time.
class TabletopFinder
{
public:
  /// Throws std::invalid_argument as validate() of the camera and of the parameters does.
  explicit TabletopFinder(const CameraModel& camera, const PlaneParams& planes = PlaneParams(),
                          const TabletopParams& params = TabletopParams());
  ~TabletopFinder();

  /// `up` is a direction in the camera's optical frame: planes that face it and are large enough are tables. Where
  /// nothing is known of it (zeros) the one with most pixels of those large enough is the table. Throws
  /// std::invalid_argument if `up` is not finite, and if `depth` is not of `encoding` (see depth_image.hpp) or not of
  /// the camera's size. The labels are the finder's own: valid until its next call.
  const Tabletop& find(const cv::Mat& depth, const std::string& encoding, const cv::Vec3d& up = cv::Vec3d());

  /// All planes of the last image.
  const PlaneSegmentation& planes() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
