#include <gtest/gtest.h>

#include <cmath>

#include "robot_vision/contours/contours.hpp"
#include "support/images.hpp"

using namespace robot_vision;

namespace
{

/// Parameters that leave nothing out.
ContourParams eager(const std::string& method, bool invert)
{
  ContourParams params;
  params.method = method;
  params.invert = invert;
  params.blur_size = 1;
  params.block_size = 3;
  params.min_area = 0.0;
  params.min_defect = 0.0;
  params.epsilon = 0.0;
  return params;
}

bool isFinite(const TurnedShape& shape)
{
  return std::isfinite(shape.center.x + shape.center.y + shape.length + shape.width + shape.angle);
}

}  // namespace

TEST(ContourFinder, takesImagesOfAnySizeAndContent)
{
  for (const char* method : {"fixed", "otsu", "adaptive_mean", "adaptive_gaussian", "canny"})
    for (const bool invert : {false, true})
    {
      ContourFinder finder(eager(method, invert));  // one for all images: nothing that it keeps may affect the next
      for (const cv::Size size : {cv::Size(1, 1), cv::Size(53, 1), cv::Size(1, 47), cv::Size(2, 2), cv::Size(37, 29)})
        for (int kind = 0; kind < 6; ++kind)
        {
          const cv::Mat image = adversarial(size, kind);
          const cv::Mat before = image.clone();
          const ContourResult result = finder.apply(image, "mono8", cv::Point2d(1e6, -1e6));
          EXPECT_TRUE(equal(image, before));
          ASSERT_EQ(result.mask.size(), size);
          EXPECT_EQ(cv::countNonZero(result.mask) > 0, !result.contours.empty()) << method << size << kind;
          for (const Contour& contour : result.contours)
          {
            EXPECT_TRUE(isFinite(contour.rectangle)) << method << size << kind;
            EXPECT_TRUE(!contour.ellipse || isFinite(*contour.ellipse)) << method << size << kind;
            EXPECT_TRUE(std::isfinite(contour.center.x + contour.center.y + contour.line_angle)) << method << size;
            EXPECT_LT(contour.point_distance, -1e6) << method << size << kind;
          }
        }
    }
}

TEST(ContourFinder, takesEveryEncodingAndDoesNotReadBesideAPartOfAnImage)
{
  ContourParams params;
  params.min_area = 0.0;
  for (const char* method : {"otsu", "adaptive_mean", "canny"})
    for (const std::string& encoding : encodings())
    {
      if (encoding == "jpeg") continue;
      params.method = method;
      const cv::Mat image = colorful({60, 48}, encoding);
      const cv::Mat padded = ContourFinder(params).apply(image, encoding).mask;
      EXPECT_TRUE(equal(padded, ContourFinder(params).apply(image.clone(), encoding).mask)) << encoding << method;
    }
}
