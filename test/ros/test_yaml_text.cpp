#include <gtest/gtest.h>

#include "ros/params/yaml_text.hpp"

using namespace robot_vision;

TEST(YamlText, getsAMissingMap)
{
  EXPECT_EQ(editYamlMap("", "controls", {{"gain", "5"}}), "controls:\n  gain: 5\n");
  EXPECT_EQ(editYamlMap("loop: true\n", "controls", {{"gain", "5"}, {"gamma", "1"}}),
            "loop: true\ncontrols:\n  gain: 5\n  gamma: 1\n");
}

TEST(YamlText, findsTheEntriesOfAMapBehindBlankLinesAndComments)
{
  for (const std::string begin : {"controls:\n\n", "controls:\n# of my lamp\n", "controls:\n     # of my lamp\n"})
  {
    const YamlValues values{{"gain", "5"}, {"gamma", "2"}};
    EXPECT_EQ(editYamlMap(begin + "  gain: 3\n", "controls", values), begin + "  gain: 5\n  gamma: 2\n");
  }
}

TEST(YamlText, keepsTheRestOfAMap)
{
  const std::string before =
      "controls:   # of the camera\n"
      "    # how bright\n"
      "    brightness: 7  # or so\n"
      "    gain: [1,\n"
      "      brightness: 3]\n"
      "\n"
      "brightness: 9\n";
  const std::string after =
      "controls:   # of the camera\n"
      "    # how bright\n"
      "    brightness: 8  # or so\n"
      "    gain: [1,\n"
      "      brightness: 3]\n"
      "    gamma: 2\n"
      "\n"
      "brightness: 9\n";
  EXPECT_EQ(editYamlMap(before, "controls", {{"brightness", "8"}, {"gamma", "2"}}), after);
}

TEST(YamlText, spreadsAMapOfOneLineOverSeveral)
{
  EXPECT_EQ(editYamlMap("controls: {gain: 1, label: \"5\"}  # mine\nloop: true\n", "controls", {{"gain", "2"}}),
            "controls:" + std::string(24, ' ') + "# mine\n  gain: 2\n  label: \"5\"\nloop: true\n");
  EXPECT_EQ(editYamlMap("controls: {}\n", "controls", {{"gain", "2"}}), "controls:\n  gain: 2\n");
}

TEST(YamlText, replacesQuotedText)
{
  const std::string after = "name: 5" + std::string(8, ' ') + "# mine\n";
  EXPECT_EQ(editYaml("name: 'it''s'  # mine\n", "name", "5"), after);
  EXPECT_EQ(editYaml("name: 'back\\'  # mine\n", "name", "5"), after);
  EXPECT_EQ(editYaml("name: \"a\\\"bc\"  # mine\n", "name", "5"), after);
  EXPECT_EQ(editYaml("name: ''''\n", "name", "5"), "name: 5\n");
  EXPECT_EQ(editYaml("name: ''\n", "name", "5"), "name: 5\n");
}

TEST(YamlText, keepsLineEndings)
{
  EXPECT_EQ(editYaml("gain: 1 # high\r\noffset: 2\r\n", "gain", "5"), "gain: 5 # high\r\noffset: 2\r\n");
  EXPECT_EQ(editYaml("gain: 1\r\n", "gamma", "5"), "gain: 1\r\ngamma: 5\r\n");
  EXPECT_EQ(editYaml("gain: 1\noffset: 2\r\n", "offset", "5"), "gain: 1\noffset: 5\r\n");
  EXPECT_EQ(editYaml("gain: 1", "gain", "5"), "gain: 5\n");
  EXPECT_EQ(editYamlMap("a: {b: 1}\r\nc: 2\r\n", "a", {{"b", "3"}, {"d", "4"}}), "a:\r\n  b: 3\r\n  d: 4\r\nc: 2\r\n");
  EXPECT_EQ(editYamlMap("a:\r\n  b: 1\r\n\r\n  c: 2\r\n", "a", {{"c", "3"}, {"d", "4"}}),
            "a:\r\n  b: 1\r\n\r\n  c: 3\r\n  d: 4\r\n");
}
