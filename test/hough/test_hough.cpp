#include <gtest/gtest.h>

#include "robot_vision/hough/hough.hpp"
#include "support/images.hpp"

using namespace robot_vision;

namespace
{

/// Parameters by which all is found that there may be.
HoughParams eager(const std::string& method, const std::string& circle_method = "gradient")
{
  HoughParams params;
  params.method = method;
  params.circle_method = circle_method;
  params.blur = "none";
  params.threshold = 1;
  params.min_length = 0.0;
  params.accumulator_threshold = 1000;
  params.perfectness = 0.0;
  params.min_radius = 0;
  return params;
}

std::vector<HoughParams> everyMethod()
{
  std::vector<HoughParams> all = {eager("lines"), eager("segments"), eager("circles")};
  const HoughParams alternative = eager("circles", "gradient_alt");
  try
  {
    validate(alternative);
    all.push_back(alternative);
  }
  catch (const std::invalid_argument&)  // OpenCV before 4.3 does not have it
  {
  }
  return all;
}

}  // namespace

TEST(HoughTransform, takesImagesOfAnySizeAndContent)
{
  for (const HoughParams& params : everyMethod())
  {
    HoughTransform transform(params);  // one for all images, because nothing that it keeps may affect the next result
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(53, 1), cv::Size(1, 47), cv::Size(2, 2), cv::Size(37, 29)})
      for (int kind = 0; kind < 6; ++kind)
      {
        const cv::Mat image = adversarial(size, kind);
        const cv::Mat before = image.clone();
        const HoughResult result = transform.apply(image, "mono8");
        EXPECT_TRUE(equal(image, before));
        ASSERT_EQ(result.edges.size(), size);
        EXPECT_LE(result.lines.size(), 50U);
        for (const HoughLine& line : result.lines)
          for (const cv::Point2d& end : {line.begin, line.end})
            EXPECT_TRUE(end.x >= 0.0 && end.y >= 0.0 && end.x <= size.width - 1 && end.y <= size.height - 1)
                << params.method << " " << size << " " << end;
        for (const HoughLine& line : result.lines)
          EXPECT_TRUE(line.score >= 0.0 && line.score <= 1.0) << line.score;
        EXPECT_TRUE(kind != 5 || (result.lines.empty() && result.circles.empty()));  // 5: a uniform image
      }
  }
}

TEST(HoughTransform, takesEveryEncodingAndDoesNotReadBesideAPartOfAnImage)
{
  for (const HoughParams& params : everyMethod())
    for (const std::string& encoding : encodings())
    {
      if (encoding == "jpeg") continue;
      const cv::Mat image = colorful({40, 30}, encoding);
      const HoughResult padded = HoughTransform(params).apply(image, encoding);
      const HoughResult whole = HoughTransform(params).apply(image.clone(), encoding);
      EXPECT_TRUE(equal(padded.edges, whole.edges)) << encoding;
      ASSERT_EQ(padded.lines.size(), whole.lines.size());
      ASSERT_EQ(padded.circles.size(), whole.circles.size());
      for (std::size_t i = 0; i < padded.lines.size(); ++i)
        EXPECT_EQ(padded.lines[i].begin, whole.lines[i].begin) << encoding;
    }
}
