#include "robot_vision/tag_families.hpp"

#include <gtest/gtest.h>

#include <set>

#include "refusal.hpp"

using namespace robot_vision;

TEST(TagFamilies, areTheEightAsTheirNamesSay)
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

TEST(TagFamilies, refusesWhatIsNotThere)
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

TEST(TagFamilies, cellsHaveTheBorderThatIsFound)
{
  for (const TagFamily& family : tagFamilies())
    for (const int id : {0, 1, family.ids - 1})
    {
      const cv::Mat cells = tagCells(family.name, id);
      ASSERT_EQ(cells.type(), CV_8UC1);
      ASSERT_EQ(cells.size(), cv::Size(family.width, family.width));
      EXPECT_EQ(cv::countNonZero(cells == 0) + cv::countNonZero(cells == 255), cells.size().area());
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

TEST(TagFamilies, tagsDifferHoweverTheyAreTurned)
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
