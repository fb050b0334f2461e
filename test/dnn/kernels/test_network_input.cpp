#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/dnn/network_input.hpp"
#include "support/images.hpp"

using namespace robot_vision;

namespace
{

/// Where a pixel of a resized side is in the side, as network_input.hpp says.
struct Sample
{
  Sample(int i, int from, int to)
  {
    const double at = std::max(0.0, (i + 0.5) * (static_cast<double>(from) / to) - 0.5);
    first = std::min(static_cast<int>(at), from - 1);
    second = std::min(first + 1, from - 1);
    share = first == second ? 0.0F : static_cast<float>(at - first);
  }

  int first, second;
  float share;
};

/// Each operation is rounded by itself, whatever the compiler would like to fuse.
float blend(float a, float b, float share)
{
  const volatile float difference = b - a;
  const volatile float part = difference * share;
  return a + part;
}

/// One value of a stretched input of planes.
float expectedAt(const cv::Mat& image, const InputParams& params, int channel, int row, int column)
{
  const Sample x(column, image.cols, params.width), y(row, image.rows, params.height);
  const int from = params.order == "rgb" ? 2 - channel : channel;
  const auto at = [&](int v, int u) { return static_cast<float>(image.at<cv::Vec3b>(v, u)[from]); };
  const float left = blend(at(y.first, x.first), at(y.second, x.first), y.share);
  const float right = blend(at(y.first, x.second), at(y.second, x.second), y.share);
  const auto c = static_cast<std::size_t>(channel);
  const volatile float scaled = blend(left, right, x.share) * static_cast<float>(1.0 / params.std[c]);
  return scaled + static_cast<float>(-params.mean[c] / params.std[c]);
}

InputParams stretched(int width, int height, const std::string& layout)
{
  InputParams params;
  params.width = width;
  params.height = height;
  params.fit = "stretch";
  params.layout = layout;
  params.mean = {123.675, 116.28, 103.53};
  params.std = {58.395, 57.12, 57.375};
  return params;
}

}  // namespace

TEST(NetworkInput, hasTheSameBitsAsPlainLoops)
{
  // Widths that leave a rest of each vector, enlarged, kept, and made smaller by so much that vectors of a row hold
  // only a few of the pixels that are wanted.
  for (const int from : {1, 2, 7, 31, 32, 64, 65, 127, 200, 641})
    for (const int to : {1, 3, 8, 16, 17, 50, 129})
    {
      const cv::Mat image = noise({from, 9}, CV_8UC3, 3);
      const cv::Mat before = image.clone();
      for (const std::string layout : {"nchw", "nhwc"})
      {
        const InputParams params = stretched(to, 7, layout);
        const bool planes = layout == "nchw";
        const std::vector<int> shape = planes ? std::vector<int>{1, 3, 7, to} : std::vector<int>{1, 7, to, 3};
        cv::Mat out(4, shape.data(), CV_32F, cv::Scalar(std::nan("")));
        fillInput(image, {{0, 0}, image.size()}, params, out);
        for (int c = 0; c < 3; ++c)
          for (int y = 0; y < 7; ++y)
            for (int x = 0; x < to; ++x)
            {
              const int at = planes ? (c * 7 + y) * to + x : (y * to + x) * 3 + c;
              ASSERT_EQ(out.ptr<float>()[at], expectedAt(image, params, c, y, x))
                  << from << " to " << to << ", " << layout << " " << c << " " << y << " " << x;
            }
      }
      EXPECT_EQ(cv::norm(image, before, cv::NORM_INF), 0.0);
    }
}
