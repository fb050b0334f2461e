#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// A family of AprilTags (Olson: AprilTag: A robust and flexible visual fiducial system, ICRA 2011; Krogius et al.:
/// Flexible layouts for fiducial tags, IROS 2019).
struct TagFamily
{
  std::string name;         // "tag36h11"
  int ids = 0;              // the tags are 0 to ids - 1
  int width = 0;            // cells, side of a tag's image
  int width_at_border = 0;  // cells between the corners that are found, where the tag's size is measured
  int distance = 0;         // bits in which any two tags differ at least
};

/// All families: tag36h11, tag25h9, tag16h5, tagStandard41h12, tagStandard52h13, tagCircle21h7, tagCircle49h12 and
/// tagCustom48h12.
const std::vector<TagFamily>& tagFamilies();

/// The family of this name. Throws std::invalid_argument naming all families if there is none.
const TagFamily& tagFamily(const std::string& name);

constexpr int kFreeCell = 128;  // value in tagCells() of a cell that has no meaning and may have any colour

/// The upright image of a tag with one pixel per cell: CV_8UC1, 0, 255 or kFreeCell, `width` cells square. The corners
/// that are found lie (width - width_at_border) / 2 cells from its edges. The classic families include their white
/// border of one cell. The others have cells outside the found corners, and the surroundings of those may have any
/// colour. So may the free cells: the corners of the image in the round families and the middle of tagCustom48h12. The
/// library prints them black. Throws std::invalid_argument as tagFamily() does, and naming the ids if the family does
/// not have this one.
cv::Mat tagCells(const std::string& family, int id);

}  // namespace robot_vision
