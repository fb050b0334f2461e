#include "robot_vision/tags/detection/tag_families.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "tag_library.hpp"

namespace robot_vision
{

namespace
{

struct Maker
{
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr Maker kMakers[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
};

FamilyPtr make(const Maker& maker)
{
  return {maker.create(), maker.destroy};
}

std::vector<TagFamily> listFamilies()
{
  std::vector<TagFamily> families;
  for (const Maker& maker : kMakers)
  {
    const FamilyPtr family = make(maker);
    families.push_back({maker.name, static_cast<int>(family->ncodes), family->total_width, family->width_at_border,
                        static_cast<int>(family->h)});
  }
  return families;
}

std::string familyNames()
{
  std::vector<std::string> names;
  for (const Maker& maker : kMakers)
    names.emplace_back(maker.name);
  return joined(names);
}

}  // namespace

const std::vector<TagFamily>& tagFamilies()
{
  static const std::vector<TagFamily> families = listFamilies();
  return families;
}

const TagFamily& tagFamily(const std::string& name)
{
  const auto& families = tagFamilies();
  const auto family =
      std::find_if(families.begin(), families.end(), [&name](const TagFamily& f) { return f.name == name; });
  require(family != families.end(), "tag family", "'" + name + "'", "one of " + familyNames());
  return *family;
}

cv::Mat tagCells(const std::string& family, int id)
{
  requireRange("id of " + family, id, 0, tagFamily(family).ids - 1);
  const FamilyPtr record = makeFamily(family);
  cv::Mat cells(record->total_width, record->total_width, CV_8UC1, cv::Scalar(kFreeCell));
  const int border = (record->total_width - record->width_at_border) / 2;
  const int outer = border - 1;  // the ring around the corners that are found
  const auto drawRing = [&cells](int first, int level)
  {
    const int side = cells.cols - 2 * first;
    cv::rectangle(cells, {first, first, side, side}, level);
  };
  drawRing(outer, record->reversed_border ? 0 : 255);
  drawRing(outer + 1, record->reversed_border ? 255 : 0);
  for (std::uint32_t bit = 0; bit < record->nbits; ++bit)
  {
    const cv::Point cell(border + static_cast<int>(record->bit_x[bit]), border + static_cast<int>(record->bit_y[bit]));
    cells.at<uchar>(cell) = (record->codes[id] >> (record->nbits - 1 - bit) & 1) != 0 ? 255 : 0;
  }
  return cells;
}

FamilyPtr makeFamily(const std::string& name)
{
  const auto index = &tagFamily(name) - tagFamilies().data();
  return make(kMakers[index]);
}

}  // namespace robot_vision
