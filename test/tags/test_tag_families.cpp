#include "robot_vision/tags/detection/tag_families.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "core/tags/detection/tag_dictionary.hpp"
#include "core/tags/detection/tag_library.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

TEST(TagFamilies, areTheEightOfTheLibrary)
{
  std::set<std::string> names;
  for (const TagFamily& family : tagFamilies())
  {
    names.insert(family.name);
    const std::string distance = family.name.substr(family.name.find('h') + 1);
    EXPECT_EQ(std::to_string(family.distance), distance) << family.name;
    EXPECT_GT(family.ids, 1);
    EXPECT_GT(family.width, family.width_at_border);
    EXPECT_EQ(tagFamily(family.name).ids, family.ids);
  }
  EXPECT_EQ(names, std::set<std::string>({"tag36h11", "tag25h9", "tag16h5", "tagStandard41h12", "tagStandard52h13",
                                          "tagCircle21h7", "tagCircle49h12", "tagCustom48h12"}));
  EXPECT_EQ(tagFamily("tag36h11").ids, 587);
  EXPECT_EQ(tagFamily("tag36h11").width, 10);
  EXPECT_EQ(tagFamily("tag36h11").width_at_border, 8);
}

TEST(TagFamilies, refuseUnknownFamiliesAndIds)
{
  const std::string names =
      "tag36h11, tag25h9, tag16h5, tagStandard41h12, tagStandard52h13, tagCircle21h7, tagCircle49h12, tagCustom48h12";
  for (const std::string name : {"tag36h10", "", "TAG36H11"})
  {
    EXPECT_EQ(refusal([&] { tagFamily(name); }), "tag family is '" + name + "', must be one of " + names);
    EXPECT_EQ(refusal([&] { tagCells(name, 0); }), "tag family is '" + name + "', must be one of " + names);
  }
  EXPECT_EQ(refusal([] { tagCells("tag16h5", 30); }), "id of tag16h5 is 30, must be from 0 to 29");
  EXPECT_EQ(refusal([] { tagCells("tag36h11", -1); }), "id of tag36h11 is -1, must be from 0 to 586");
}

TEST(TagFamilies, cellsHaveTheBorderThatTheDetectorFinds)
{
  for (const TagFamily& family : tagFamilies())
    for (const int id : {0, 1, family.ids - 1})
    {
      const cv::Mat cells = tagCells(family.name, id);
      ASSERT_EQ(cells.type(), CV_8UC1);
      ASSERT_EQ(cells.size(), cv::Size(family.width, family.width));
      const int first = (family.width - family.width_at_border) / 2;
      const int last = family.width - 1 - first;
      for (int i = first; i <= last; ++i)
        for (const cv::Point inner : {cv::Point(i, first), cv::Point(i, last), cv::Point(first, i), cv::Point(last, i)})
        {
          const int inside = cells.at<uchar>(inner);
          EXPECT_EQ(inside, cells.at<uchar>(first, first)) << family.name << inner;
          const cv::Point step(inner.x == first ? -1 : inner.x == last, inner.y == first ? -1 : inner.y == last);
          EXPECT_EQ(cells.at<uchar>(inner + step), 255 - inside) << family.name << inner;
        }
    }
}

TEST(TagFamilies, cellsAreThoseOfTheLibrary)
{
  for (const TagFamily& family : tagFamilies())
  {
    const FamilyPtr record = makeFamily(family.name);
    for (const int id : {0, 1, family.ids / 2, family.ids - 1})
    {
      const std::unique_ptr<image_u8_t, void (*)(void*)> printed(apriltag_to_image(record.get(), id), std::free);
      const std::unique_ptr<uchar, void (*)(void*)> pixels(printed->buf, std::free);
      const cv::Mat expected(printed->height, printed->width, CV_8UC1, printed->buf,
                             static_cast<std::size_t>(printed->stride));
      const cv::Mat cells = tagCells(family.name, id);
      EXPECT_TRUE(equal(cells == 255, expected == 255)) << family.name << id;
      EXPECT_EQ(cv::countNonZero((cells != 255) & (expected != 0)), 0) << family.name << id;
    }
  }
}

TEST(TagFamilies, freeCellsAreNeitherBitsNorBorder)
{
  for (const TagFamily& family : tagFamilies())
  {
    const cv::Mat free_cells = tagCells(family.name, 0) == kFreeCell;
    const int bits = std::stoi(family.name.substr(family.name.find_first_of("0123456789")));
    const int rings = 8 * family.width_at_border;  // a cell wide, within and around the corners that are found
    EXPECT_EQ(cv::countNonZero(free_cells), family.width * family.width - rings - bits) << family.name;
    cv::Mat black_in_all = cv::Mat::ones(free_cells.size(), CV_8UC1), white_in_all = black_in_all.clone();
    for (int id = 0; id < family.ids; id += std::max(family.ids / 200, 1))
    {
      const cv::Mat cells = tagCells(family.name, id);
      EXPECT_TRUE(equal(cells == kFreeCell, free_cells)) << family.name << id;
      black_in_all &= cells == 0;
      white_in_all &= cells == 255;
    }
    const int always_the_same = cv::countNonZero(black_in_all) + cv::countNonZero(white_in_all);
    EXPECT_EQ(always_the_same, rings) << family.name;
  }
}

TEST(TagFamilies, tagsDifferInEveryOrientation)
{
  for (const TagFamily& family : tagFamilies())
  {
    const cv::Mat first = tagCells(family.name, 0);
    cv::Mat turned = first;
    for (int turns = 0; turns < 4; ++turns)
    {
      for (const int id : {1, family.ids / 2, family.ids - 1})
        EXPECT_GE(cv::countNonZero(turned != tagCells(family.name, id)), family.distance) << family.name << id << turns;
      cv::rotate(turned, turned, cv::ROTATE_90_CLOCKWISE);
    }
  }
}

TEST(TagDictionary, isSharedWhileItIsInUse)
{
  std::shared_ptr<const TagDictionary> first = TagDictionary::of({"tag16h5", "tag25h9"}, 1);
  EXPECT_EQ(TagDictionary::of({"tag16h5", "tag25h9"}, 1), first);
  EXPECT_NE(TagDictionary::of({"tag16h5", "tag25h9"}, 0), first);
  EXPECT_NE(TagDictionary::of({"tag16h5"}, 1), first);
  const std::weak_ptr<const TagDictionary> gone = first;
  first.reset();
  EXPECT_TRUE(gone.expired());
}
