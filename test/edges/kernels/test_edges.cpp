#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/imgproc.hpp>

#include "core/image/box_kernels.hpp"
#include "robot_vision/edges/edges.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

cv::Mat byOpenCv(const cv::Mat& image, const std::string& encoding, const EdgeParams& p)
{
  const cv::Mat whole = image.clone();  // OpenCV's filters would read the pixels around a part of a larger matrix
  cv::Mat smooth, edges;
  cv::blur(converted(whole, encoding, "mono8"), smooth, {p.blur_size, p.blur_size});
  cv::Canny(smooth, edges, p.low_threshold, p.high_threshold, p.aperture, p.l2_gradient);
  return edges;
}

cv::Mat edgesOf(const cv::Mat& image, const std::string& encoding, const EdgeParams& params = {})
{
  cv::Mat edges;
  EdgeDetector(params).apply(image, encoding, edges);
  return edges;
}

}  // namespace

TEST(EdgeDetector, equalsTheOpenCvChainForEveryParameter)
{
  const cv::Mat image = smooth({97, 61});
  for (const EdgeParams& params : {EdgeParams{}, EdgeParams{1, 50, 150, 3, false}, EdgeParams{3, 0, 0, 3, true},
                                   EdgeParams{31, 1, 2, 5, false}, EdgeParams{7, 100, 900, 7, true}})
    EXPECT_TRUE(equal(edgesOf(image, "bgr8", params), byOpenCv(image, "bgr8", params)))
        << params.blur_size << ", " << params.aperture;
}

TEST(EdgeDetector, equalsTheOpenCvChainForEveryEncodingAndSize)
{
  EdgeDetector detector;  // one for all images, because nothing that it keeps may affect the next result
  for (const std::string& encoding : encodings())
    for (const cv::Size size : {cv::Size(80, 60), cv::Size(2, 3), cv::Size(6, 240), cv::Size(80, 60)})
    {
      if (encoding == "jpeg") continue;
      const cv::Mat image = colorful(size, encoding);
      const cv::Mat before = image.clone();
      cv::Mat edges;
      detector.apply(image, encoding, edges);
      EXPECT_TRUE(equal(edges, byOpenCv(image, encoding, EdgeParams{}))) << encoding << " " << size;
      EXPECT_TRUE(equal(image, before)) << encoding;
    }
}

TEST(EdgeDetector, equalsTheOpenCvChainWithAnyNumberOfThreads)
{
  cv::RNG random(0x5A4E);
  for (const int threads : {1, 2, 7, 64})
  {
    const EdgeParams params{5, 10, 40, 3, false, threads};
    EdgeDetector detector(params);
    for (const std::string encoding : {"bgr8", "mono16", "rgba8", "yuv422", "mono8"})
      for (const int rows : {200, 3, 61})
      {
        const cv::Mat image = colorful({2 * random.uniform(1, 80), rows}, encoding);
        cv::Mat edges;
        detector.apply(image, encoding, edges);
        EXPECT_TRUE(equal(edges, byOpenCv(image, encoding, params))) << encoding << " " << rows << " " << threads;
      }
  }
}

/// A spiral line of one pixel, whose turns are three pixels apart.
cv::Mat spiral(int size)
{
  cv::Mat image(size, size, CV_8UC1, cv::Scalar(0));
  cv::Point at(0, 0);
  cv::Point step(1, 0);
  for (int length = size - 1; length > 0; length -= step.x == 0 ? 0 : 3)
  {
    cv::line(image, at, at + step * length, 255);
    at += step * length;
    step = {-step.y, step.x};
  }
  return image;
}

TEST(EdgeDetector, equalsTheOpenCvChainForAdversarialImages)
{
  cv::RNG random(0xED6E);
  for (int i = 0; i < 300; ++i)
  {
    const cv::Size size(random.uniform(1, 200), random.uniform(1, 90));
    EdgeParams params{1 + 2 * random.uniform(0, 16), random.uniform(0.0, 90.0), 0, 3, i % 2 == 0};
    params.high_threshold = params.low_threshold + random.uniform(0.0, 120.0);
    params.threads = random.uniform(1, 5);
    const cv::Mat image = adversarial(size, i);
    ASSERT_TRUE(equal(edgesOf(image, "mono8", params), byOpenCv(image, "mono8", params)))
        << "image " << i << ", " << size << ", blur " << params.blur_size << ", " << params.low_threshold << " to "
        << params.high_threshold << ", " << params.threads << " threads";
  }
}

TEST(EdgeDetector, followsAnEdgeThatWinds)
{
  cv::Mat image = spiral(301) / 8;         // a weak edge
  image.at<std::uint8_t>(150, 150) = 255;  // a strong pixel in its middle
  for (const int high : {100, 2000})
  {
    const EdgeParams params{1, 5, 1.0 * high, 3, false};
    EXPECT_TRUE(equal(edgesOf(image, "mono8", params), byOpenCv(image, "mono8", params))) << high;
  }
}

TEST(BoxDivision, isRoundedForEverySum)
{
  for (int side = 3; side <= 15; side += 2)
  {
    const int divisor = side * side;
    const BoxDivision division(divisor);
    std::vector<std::uint16_t> sums(static_cast<std::size_t>(255 * divisor + 1));
    std::iota(sums.begin(), sums.end(), std::uint16_t{0});
    std::vector<std::uint8_t> quotients(sums.size());
    kernels<BoxKernels<std::uint16_t>>().divide(sums.data(), division, static_cast<int>(sums.size()), quotients.data());
    for (std::size_t i = 0; i < sums.size(); ++i)
      ASSERT_EQ(quotients[i], (2 * sums[i] + divisor) / (2 * divisor)) << sums[i] << " / " << divisor;
  }
}

TEST(EdgeDetector, marksAStepOnlyAtTheStep)
{
  cv::Mat image(40, 40, CV_8UC1, cv::Scalar(0));
  image.colRange(20, 40).setTo(200);
  const cv::Mat edges = edgesOf(image, "mono8");
  EXPECT_EQ(cv::countNonZero(edges.colRange(17, 23)), 40);
  EXPECT_EQ(cv::countNonZero(edges), 40);
}

TEST(EdgeDetector, takesOnePixel)
{
  const cv::Mat edges = edgesOf(cv::Mat(1, 1, CV_8UC3, cv::Scalar::all(9)), "bgr8");
  EXPECT_EQ(edges.size(), cv::Size(1, 1));
  EXPECT_EQ(cv::countNonZero(edges), 0);
}

TEST(EdgeDetector, reusesTheOutputsMemory)
{
  std::vector<std::uint8_t> memory(60 * 100, 77);
  cv::Mat edges(60, 80, CV_8UC1, memory.data(), 100);
  EdgeDetector().apply(smooth({80, 60}), "bgr8", edges);
  EXPECT_EQ(edges.data, memory.data());
  EXPECT_TRUE(equal(edges, byOpenCv(smooth({80, 60}), "bgr8", EdgeParams{})));
  EXPECT_EQ(memory[80], 77);  // the padding of the first row
}

TEST(EdgeDetector, refusesEmptyImagesAndOtherTypes)
{
  EXPECT_THROW(edgesOf(cv::Mat(), "bgr8"), std::invalid_argument);
  EXPECT_THROW(edgesOf(cv::Mat(4, 4, CV_8UC1), "bgr8"), std::invalid_argument);
}

TEST(EdgeDetector, refusesParametersOutOfRange)
{
  EXPECT_EQ(refusalWith(&EdgeParams::high_threshold, 2), "high_threshold is 2, must be at least low_threshold, 15");
  EXPECT_EQ(refusalWith(&EdgeParams::aperture, 4), "aperture is 4, must be 3, 5 or 7");
  EXPECT_EQ(refusal([] { EdgeDetector{EdgeParams{7, 1, 2, 9}}; }), "aperture is 9, must be 3, 5 or 7");
}
