#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "core/png.hpp"
#include "pictures.hpp"

using namespace robot_vision;

// And not by its pixels: they are decoded once, when the kind is known.
TEST(Png, tellsItsKindInItsHeader)
{
  for (const auto& [type, color, wide] : {std::tuple{CV_8UC1, false, false},
                                          {CV_8UC3, true, false},
                                          {CV_8UC4, true, false},
                                          {CV_16UC1, false, true},
                                          {CV_16UC3, true, true}})
  {
    std::vector<std::uint8_t> bytes;
    encodePng(noise({5, 3}, type), 1, bytes);
    const std::vector<std::uint8_t> name = {'I', 'D', 'A', 'T'};
    const auto pixels = std::search(bytes.begin(), bytes.end(), name.begin(), name.end()) + 4;
    *pixels ^= 0xFF;
    const PngInfo info = readPngInfo(bytes.data(), bytes.size());
    EXPECT_EQ(std::tie(info.color, info.wide), std::tie(color, wide)) << cv::typeToString(type);
  }
}
