#include <gtest/gtest.h>

#include "robot_vision/filters/filter_chain.hpp"
#include "support/images.hpp"

using namespace robot_vision;

TEST(FilterChain, doesNotSeeWhatIsAroundAnImage)
{
  const cv::Size size(40, 30);
  const cv::Rect middle({10, 10}, size);
  for (const Operation& operation : operations())
    for (const char* encoding : {"bgr8", "mono8"})
    {
      const cv::Mat part = noise(size + cv::Size(20, 20), matType(encoding))(middle);
      const std::vector<std::string> chain = {operation.name};
      cv::Mat out;
      cv::Mat expected;
      FilterChain(chain).apply({part, encoding}, out);
      FilterChain(chain).apply({part.clone(), encoding}, expected);
      EXPECT_TRUE(equal(out, expected)) << operation.name << " of " << encoding;
    }
}
