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
  cv::Mat plain, equalized;
  toEqualizedGray(image, encoding, plain, equalized);
  ASSERT_TRUE(equal(plain, gray)) << encoding << ' ' << image.size() << ' ' << cv::getNumThreads();
  ASSERT_TRUE(equal(equalized, expected)) << encoding << ' ' << image.size() << ' ' << cv::getNumThreads();
  EXPECT_TRUE(equal(image, before));
}

/// Tests with one thread and with several. Each number is set only once, because OpenCV takes a while to end and start
/// its threads.
class HistogramEqualization : public testing::TestWithParam<int>
{
  ThreadCount threads_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(InThreads, HistogramEqualization, testing::Values(1, 3));

}  // namespace

TEST_P(HistogramEqualization, equalsOpenCvForEveryEncoding)
{
  for (const std::string& encoding : encodings())
  {
    if (encoding == "jpeg") continue;
    for (const cv::Size size : {cv::Size(640, 483), cv::Size(38, 51), cv::Size(2, 3)})
      expectOpenCvs(noise(size, matType(encoding), /*row_padding=*/6), encoding);
  }
}

TEST_P(HistogramEqualization, equalsOpenCvForAllKindsOfImages)
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

TEST_P(HistogramEqualization, equalsOpenCvForASingleLevel)
{
  for (const int level : {0, 1, 200, 255})
    expectOpenCvs(cv::Mat(9, 21, CV_8UC1, cv::Scalar(level)), "mono8");
}
