#include <gtest/gtest.h>

#include "robot_vision/common/on_demand.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

TEST(OnDemand, saysWhatIsMissing)
{
  const std::string library = refusal<std::runtime_error>([] { onDemand("nothing", "robot_vision_imdecode"); });
  EXPECT_NE(library.find("/librobot_vision_nothing.so cannot be loaded: "), std::string::npos) << library;
  const std::string function = refusal<std::runtime_error>([] { onDemand("codecs", "nothing"); });
  EXPECT_NE(function.find("/librobot_vision_codecs.so has no function nothing"), std::string::npos) << function;
}

TEST(OnDemand, givesTheSameFunctionEachTime)
{
  EXPECT_EQ(onDemand("codecs", "robot_vision_imdecode"), onDemand("codecs", "robot_vision_imdecode"));
}
