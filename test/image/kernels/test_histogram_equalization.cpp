#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/image/histogram_equalization.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

void expectOpenCvs(const cv::Mat& image, const std::string& encoding)
{
  const cv::Mat before = image.clone(), gray = converted(image, encoding, "mono8");
  cv::Mat expected;
  cv::equalizeHist(gray, expected);
  for (const int threads : {1, 3})
  {
    const ThreadCount count(threads);
    cv::Mat plain, equalized;
    toEqualizedGray(image, encoding, plain, equalized);
    ASSERT_TRUE(equal(plain, gray)) << encoding << ' ' << image.size() << ' ' << threads;
    ASSERT_TRUE(equal(equalized, expected)) << encoding << ' ' << image.size() << ' ' << threads;
  }
  EXPECT_TRUE(equal(image, before));
}

}  // namespace

TEST(HistogramEqualization, equalsOpenCvForEveryEncoding)
{
  for (const std::string& encoding : encodings())
  {
    if (encoding == "jpeg") continue;
    for (const cv::Size size : {cv::Size(640, 483), cv::Size(38, 51), cv::Size(2, 3)})
      expectOpenCvs(noise(size, matType(encoding), /*row_padding=*/6), encoding);
  }
}

TEST(HistogramEqualization, equalsOpenCvForAllKindsOfImages)
{
  cv::RNG random(7);
  for (int i = 0; i < 200; ++i)
  {
    const cv::Size size(random.uniform(1, 90), random.uniform(1, 40));
    cv::Mat image = adversarial(size, i);
    if (i % 3 == 0) image = image / random.uniform(2, 60) + random.uniform(0, 100);  // few levels
    expectOpenCvs(image, "mono8");
  }
  expectOpenCvs(adversarial({4096, 2160}, 4), "mono8");
}

TEST(HistogramEqualization, equalsOpenCvForASingleLevel)
{
  for (const int level : {0, 1, 200, 255})
    expectOpenCvs(cv::Mat(9, 21, CV_8UC1, cv::Scalar(level)), "mono8");
}
