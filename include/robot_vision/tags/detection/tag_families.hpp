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
  int width = 0;            // cells, side of the image of a tag
  int width_at_border = 0;  // cells between the corners that are found: the tag's size is measured there
  int distance = 0;         // bits by which any two tags differ at least
};

/// All of them: tag36h11, tag25h9, tag16h5, tagStandard41h12, tagStandard52h13, tagCircle21h7, tagCircle49h12 and
/// tagCustom48h12.
const std::vector<TagFamily>& tagFamilies();

/// Throws std::invalid_argument naming the families if there is none of this name.
const TagFamily& tagFamily(const std::string& name);

constexpr int kFreeCell = 128;  // in tagCells(): it has no meaning, and may have any color

/// Image of an upright tag: CV_8UC1, 0, 255 or kFreeCell, a pixel per cell, `width` cells square, the found corners
/// (width - width_at_border) / 2 cells from its edges. The classic families bring their white border of one cell. The
/// others have cells outside the found corners; what lies around those may have any color. So may the free cells: the
/// corners of the image in the round families and the middle of tagCustom48h12, which the library prints in black.
/// Throws std::invalid_argument as tagFamily() does, and naming the ids if the family has no tag of this one.
cv::Mat tagCells(const std::string& family, int id);

}  // namespace robot_vision
