#include <gtest/gtest.h>

#include <limits>

#include "ros/camera/control_messages.hpp"

using namespace robot_vision;

namespace
{

CameraControl control(const std::string& name, ControlKind kind, std::int64_t maximum, const ControlValue& value)
{
  CameraControl control;
  control.name = name;
  control.kind = kind;
  control.maximum = maximum;
  control.has_value = true;
  control.value = value;
  return control;
}

std::int64_t number(std::int64_t value)
{
  return value;
}

std::vector<CameraControl> someControls()
{
  std::vector<CameraControl> controls = {
      control("gain", ControlKind::kInteger, 255, number(7)),
      control("pixel_rate", ControlKind::kInteger, 1LL << 40, number(1LL << 35)),
      control("mute", ControlKind::kBoolean, 1, true),
      control("label", ControlKind::kText, 8, std::string("front")),
      control("menu", ControlKind::kMenu, 1, number(1)),
      control("reset", ControlKind::kButton, 0, number(0)),
      control("matrix", ControlKind::kCompound, 0, number(0)),
      control("serial", ControlKind::kInteger, 255, number(3)),
  };
  controls[4].items = {{0, "it's \\ off\n"}, {1, "on"}};
  controls[5].has_value = false;
  controls[7].read_only = true;
  return controls;
}

}  // namespace

TEST(ControlMessages, describeWhatCanBeSet)
{
  const auto description = toDescription(someControls());
  ASSERT_EQ(description.groups.size(), 1U);
  std::vector<std::pair<std::string, std::string>> types;
  for (const auto& parameter : description.groups[0].parameters)
    types.emplace_back(parameter.name, parameter.type);
  EXPECT_EQ(types, (std::vector<std::pair<std::string, std::string>>{{"gain", "int"},
                                                                     {"pixel_rate", "double"},
                                                                     {"mute", "bool"},
                                                                     {"label", "str"},
                                                                     {"menu", "int"},
                                                                     {"reset", "bool"}}));
  EXPECT_EQ(description.max.ints[0].value, 255);
  EXPECT_EQ(description.max.doubles[0].value, 1099511627776.0);
}

TEST(ControlMessages, quoteTheTextOfMenusForPython)
{
  const std::string edit = toDescription(someControls()).groups[0].parameters[4].edit_method;
  EXPECT_NE(edit.find("{'name': 'it\\'s \\\\ off', 'type': 'int', 'value': 0,"), std::string::npos) << edit;
}

TEST(ControlMessages, containThePresentValues)
{
  const auto config = toConfig(someControls());
  EXPECT_EQ(config.ints[0].value, 7);
  EXPECT_EQ(config.doubles[0].value, 34359738368.0);
  EXPECT_EQ(config.bools[0].value, 1);
  EXPECT_EQ(config.bools[1].value, 0);  // a button that is not pressed
  EXPECT_EQ(config.strs[0].value, "front");
}

TEST(ControlMessages, findWhatIsToBeChanged)
{
  auto config = toConfig(someControls());
  EXPECT_TRUE(changes(someControls(), config).empty());
  config.ints[0].value = 8;
  config.doubles[0].value = 5.0;
  config.bools[1].value = 1;
  config.strs[0].name = "other";
  const auto asked = changes(someControls(), config);
  ASSERT_EQ(asked.size(), 4U);
  const auto has = [&asked](const std::string& name, const ControlValue& value)
  {
    for (const ControlSetting& setting : asked)
      if (setting.name == name) return setting.value == value;
    return false;
  };
  EXPECT_TRUE(has("gain", number(8)));
  EXPECT_TRUE(has("pixel_rate", number(5)));
  EXPECT_TRUE(has("reset", true));
  EXPECT_TRUE(has("other", std::string("front")));  // kept although the camera does not have it, so that it is reported
}

TEST(ControlMessages, containSettingsToBeSaved)
{
  const auto config = toConfig(std::vector<ControlSetting>{
      {"a", true}, {"b", number(3)}, {"c", number(1LL << 35)}, {"d", std::string("50 Hz")}});
  EXPECT_EQ(config.bools[0].name, "a");
  EXPECT_EQ(config.ints[0].value, 3);
  EXPECT_EQ(config.doubles[0].value, 34359738368.0);
  EXPECT_EQ(config.strs[0].value, "50 Hz");
}
