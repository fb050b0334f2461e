// The descriptions of the fields of a parameters struct, and checkFields().

#include "robot_vision/common/fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

struct ZooParams
{
  int cages = 3;
  double size = 2.5;
  int doors = 1;
  double speed = 1.0;
  int legs = 4;
  std::string animal = "bear";
  std::string food = "hay";
  bool open = true;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("cages", &ZooParams::cages, Range{1, 1000000}, "", "rows of them");
    visit("size", &ZooParams::size, Range{0.5, 10}, "m", "of a cage");
    visit("doors", &ZooParams::doors, OddRange{1, 5}, "", "of a cage");
    visit("speed", &ZooParams::speed, Above{0, 2}, "m/s", "of the keeper");
    visit("legs", &ZooParams::legs, OneOf{"2, 4 or 6"}, "", "of the animal");
    visit("animal", &ZooParams::animal, OneOf{"bear, ant or gorilla", "'"}, "", "that is shown");
    visit("food", &ZooParams::food, Anything{}, "", "of the animal");
    visit("open", &ZooParams::open, Anything{}, "", "for visitors");
  }
};

void validate(const ZooParams& params)
{
  checkFields(params);
}

const double kNan = std::nan("");
const double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST(Fields, defaultsAreWithinTheirLimits)
{
  EXPECT_EQ(refusal([] { checkFields(ZooParams()); }), "");
}

TEST(Fields, rangesIncludeTheirEnds)
{
  EXPECT_EQ(refusalWith(&ZooParams::size, 0.5), "");
  EXPECT_EQ(refusalWith(&ZooParams::size, 10.0), "");
  EXPECT_EQ(refusalWith(&ZooParams::size, 0.49), "size is 0.49, must be from 0.5 to 10");
  EXPECT_EQ(refusalWith(&ZooParams::size, 11.0), "size is 11, must be from 0.5 to 10");
  EXPECT_EQ(refusalWith(&ZooParams::cages, 0), "cages is 0, must be from 1 to 1e+06");
}

TEST(Fields, rangesDoNotIncludeNan)
{
  EXPECT_EQ(refusalWith(&ZooParams::size, kNan), "size is nan, must be from 0.5 to 10");
  EXPECT_EQ(refusalWith(&ZooParams::size, kInfinity), "size is inf, must be from 0.5 to 10");
  EXPECT_EQ(refusalWith(&ZooParams::speed, kNan), "speed is nan, must be above 0 and at most 2");
  EXPECT_EQ(refusal([] { checkField("doors", kNan, OddRange{1, 5}); }), "doors is nan, must be odd and from 1 to 5");
  EXPECT_EQ(refusal([] { checkField("legs", kNan, OneOf{"2 or 4"}); }), "legs is nan, must be 2 or 4");
}

TEST(Fields, oddRangesIncludeOnlyOddNumbers)
{
  for (const int good : {1, 3, 5})
    EXPECT_EQ(refusalWith(&ZooParams::doors, good), "") << good;
  for (const int bad : {-1, 0, 2, 4, 7})
    EXPECT_EQ(refusalWith(&ZooParams::doors, bad), "doors is " + std::to_string(bad) + ", must be odd and from 1 to 5");
}

TEST(Fields, aboveExcludesItsLowEnd)
{
  EXPECT_EQ(refusalWith(&ZooParams::speed, 2.0), "");
  EXPECT_EQ(refusalWith(&ZooParams::speed, 1e-300), "");
  EXPECT_EQ(refusalWith(&ZooParams::speed, 0.0), "speed is 0, must be above 0 and at most 2");
  EXPECT_EQ(refusalWith(&ZooParams::speed, 2.1), "speed is 2.1, must be above 0 and at most 2");
  EXPECT_EQ(refusal([] { checkField("gap", 0.0, Above{0, 60, " to "}); }), "gap is 0, must be above 0 to 60");
}

TEST(Fields, choicesAreTheWordsOfTheList)
{
  for (const int good : {2, 4, 6})
    EXPECT_EQ(refusalWith(&ZooParams::legs, good), "") << good;
  EXPECT_EQ(refusalWith(&ZooParams::legs, 5), "legs is 5, must be 2, 4 or 6");
  for (const std::string good : {"bear", "ant", "gorilla"})
    EXPECT_EQ(refusalWith(&ZooParams::animal, good), "") << good;
  for (const std::string bad : {"", "or", "Bear", "bea", "bear, ant", "ant or gorilla", " ant", "zebra"})
    EXPECT_EQ(refusalWith(&ZooParams::animal, bad), "animal is '" + bad + "', must be bear, ant or gorilla");
  EXPECT_EQ(refusal([] { checkField("animal", "ant", OneOf{"bear"}); }), "animal is ant, must be bear");
  EXPECT_EQ(refusal([] { checkField("animal", "bear", OneOf{"bear"}); }), "");
}

TEST(Fields, theFirstOneIsNamed)
{
  ZooParams params;
  params.legs = 3;
  params.size = 0.0;
  EXPECT_EQ(refusal([&] { checkFields(params); }), "size is 0, must be from 0.5 to 10");
}

TEST(Fields, anythingHasNoLimits)
{
  EXPECT_EQ(refusalWith(&ZooParams::food, std::string()), "");
  EXPECT_EQ(refusalWith(&ZooParams::open, false), "");
  EXPECT_EQ(limitsText(Anything()), "");
}

TEST(Fields, structsAreComparedByAllOfThem)
{
  const ZooParams params;
  EXPECT_TRUE(equalFields(params, ZooParams()));
  ZooParams other;
  other.open = false;
  EXPECT_FALSE(equalFields(params, other));
  other = ZooParams();
  other.cages = 4;
  EXPECT_FALSE(equalFields(params, other));
}
