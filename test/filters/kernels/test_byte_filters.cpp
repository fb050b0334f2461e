#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "core/filters/adaptive_threshold.hpp"
#include "core/filters/box_filter.hpp"
#include "core/filters/derivative_filter.hpp"
#include "core/filters/gaussian_filter.hpp"
#include "core/filters/median_filter.hpp"
#include "core/filters/pyramid_filter.hpp"
#include "core/filters/tile_equalization.hpp"
#include "support/images.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

// With rests of every kind for vectors of 16, 32 and 64 bytes, and smaller than windows.
const cv::Size kSizes[] = {{64, 48}, {67, 20}, {131, 9}, {23, 33}, {200, 3}, {1, 1}, {5, 40}, {90, 1}};
const int kTypes[] = {CV_8UC1, CV_8UC3, CV_8UC4};

/// Noise, a chess board and other images on which filters tend to go wrong, with padded rows.
std::vector<cv::Mat> images(const cv::Size& size, int type)
{
  std::vector<cv::Mat> all = {noise(size, type, 5)};
  for (int kind = 1; kind < 4; ++kind)
    all.push_back(converted(adversarial(size, kind), type == CV_8UC1   ? -1
                                                     : type == CV_8UC3 ? cv::COLOR_GRAY2BGR
                                                                       : cv::COLOR_GRAY2BGRA));
  return all;
}

/// Compares ours(image, out) with theirs(image, out) for images of all sizes and types.
template <class Ours, class Theirs>
void expectEqual(const std::string& name, const Ours& ours, const Theirs& theirs)
{
  for (const int type : kTypes)
    for (const cv::Size& size : kSizes)
      for (const cv::Mat& image : images(size, type))
      {
        const cv::Mat before = image.clone();  // by itself: OpenCV takes pixels around a part of an image for its own
        cv::Mat out;
        cv::Mat expected;
        ours(image, out);
        theirs(before, expected);
        EXPECT_TRUE(equal(out, expected)) << name << ", " << size << ", type " << type;
        EXPECT_TRUE(equal(image, before)) << name;
      }
}

}  // namespace

TEST(MedianFilter, equalsOpenCv)
{
  for (const int size : {1, 3, 5, 7, 9, 11, 13, 21})
    expectEqual(
        "size " + std::to_string(size), [=](const cv::Mat& image, cv::Mat& out) { medianFilter(image, size, out); },
        [=](const cv::Mat& image, cv::Mat& out) { cv::medianBlur(image, out, size); });
}

TEST(BoxFilter, equalsOpenCv)
{
  for (const int size : {1, 3, 5, 7, 15, 17, 31, 33})
    for (const int border : {cv::BORDER_DEFAULT, cv::BORDER_REPLICATE})
      expectEqual(
          "size " + std::to_string(size),
          [=](const cv::Mat& image, cv::Mat& out) { boxFilter(image, size, border, out); },
          [=](const cv::Mat& image, cv::Mat& out) {
            cv::blur(image, out, {size, size}, {-1, -1}, border);
          });
}

TEST(GaussianFilter, equalsOpenCv)
{
  const std::pair<int, double> windows[] = {{1, 0.0},  {3, 0.0},  {5, 0.0},  {5, 0.3}, {7, 1.1},
                                            {15, 0.0}, {31, 9.0}, {63, 0.0}, {0, 2.0}, {0, 12.5}};
  for (const auto& [size, sigma] : windows)
    expectEqual(
        "size " + std::to_string(size) + ", sigma " + std::to_string(sigma),
        [size = size, sigma = sigma](const cv::Mat& image, cv::Mat& out)
        { GaussianFilter(size, sigma).apply(image, out); },
        [size = size, sigma = sigma](const cv::Mat& image, cv::Mat& out) {
          cv::GaussianBlur(image, out, {size, size}, sigma);
        });
}

TEST(GaussianFilter, takesAPartOfAnImageByItself)
{
  const cv::Mat image = noise({90, 70}, CV_8UC3, 3);
  const cv::Mat part = image({20, 10, 40, 30});
  cv::Mat out;
  cv::Mat expected;
  GaussianFilter(9, 0.0).apply(part, out);
  cv::GaussianBlur(part.clone(), expected, {9, 9}, 0.0);
  EXPECT_TRUE(equal(out, expected));
}

TEST(PyramidDown, equalsOpenCv)
{
  expectEqual(
      "half the size", [](const cv::Mat& image, cv::Mat& out) { pyramidDown(image, out); },
      [](const cv::Mat& image, cv::Mat& out) { cv::pyrDown(image, out); });
}

TEST(DerivativeMagnitude, equalsOpenCv)
{
  for (const Derivative d : {Derivative{1, 0, 3, 1.0},
                             {0, 1, 3, 1.0},
                             {1, 1, 3, 1.0},
                             {2, 0, 3, 1.0},
                             {2, 2, 5, 1.0},
                             {1, 0, 5, 1.0},
                             {0, 2, 5, 1.0},
                             {1, 0, 7, 1.0},
                             {1, 0, 1, 1.0},
                             {1, 0, 3, 0.5},
                             {1, 0, cv::FILTER_SCHARR, 1.0},
                             {0, 1, cv::FILTER_SCHARR, 1.0}})
    expectEqual(
        "derivative " + std::to_string(d.dx) + ", " + std::to_string(d.dy) + " of size " + std::to_string(d.size),
        [=](const cv::Mat& image, cv::Mat& out) { derivativeMagnitude(image, d, out); },
        [=](const cv::Mat& image, cv::Mat& out)
        {
          cv::Mat derivative;
          cv::Sobel(image, derivative, CV_16S, d.dx, d.dy, d.size, d.scale);
          cv::convertScaleAbs(derivative, out);
        });
}

TEST(AdaptiveMeanThreshold, equalsOpenCv)
{
  for (const cv::Size& size : kSizes)
    for (const cv::Mat& gray : images(size, CV_8UC1))
      for (const int side : {3, 11, 31, 51})
        for (const double offset : {-255.0, -3.5, 0.0, 2.0, 2.5, 255.0})
          for (const bool inverse : {false, true})
          {
            cv::Mat out;
            cv::Mat expected;
            adaptiveMeanThreshold(gray, side, offset, inverse, out);
            cv::adaptiveThreshold(gray.clone(), expected, 255.0, cv::ADAPTIVE_THRESH_MEAN_C,
                                  inverse ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY, side, offset);
            EXPECT_TRUE(equal(out, expected)) << size << ", " << side << ", " << offset << ", " << inverse;
          }
}

TEST(TileEqualizer, equalsOpenCv)
{
  for (const int type : {CV_8UC1, CV_16UC1})
    for (const cv::Size& size : {cv::Size(64, 48), {333, 251}, {131, 9}, {1, 1}, {8, 1}, {5, 40}})
      for (const double limit : {0.1, 2.0, 40.0})
        for (const int tiles : {1, 2, 8, 13})
        {
          if (type == CV_16UC1 && tiles > 2 && size.width != 64) continue;  // OpenCV's own, which takes long
          const cv::Mat gray = noise(size, type, 5);
          cv::Mat soft;
          cv::GaussianBlur(gray, soft, {}, 3.0);
          for (const cv::Mat& image : {gray, soft})
          {
            cv::Mat out;
            cv::Mat expected;
            TileEqualizer(limit, tiles).apply(image, out);
            cv::createCLAHE(limit, {tiles, tiles})->apply(image.clone(), expected);
            EXPECT_TRUE(equal(out, expected)) << size << ", " << limit << ", " << tiles << ", type " << type;
          }
        }
}

TEST(ByteFilters, areTheSameByAnyNumberOfThreads)
{
  const cv::Mat image = noise({200, 300}, CV_8UC3);
  const cv::Mat gray = noise({200, 300}, CV_8UC1);
  const auto all = [&]
  {
    std::vector<cv::Mat> results(6);
    medianFilter(image, 7, results[0]);
    boxFilter(image, 9, cv::BORDER_DEFAULT, results[1]);
    derivativeMagnitude(image, {}, results[2]);
    TileEqualizer(2.0, 8).apply(gray, results[3]);
    GaussianFilter(9, 0.0).apply(image, results[4]);
    pyramidDown(image, results[5]);
    return results;
  };
  const ThreadCount one(1);
  const std::vector<cv::Mat> expected = all();
  const ThreadCount three(3);
  const std::vector<cv::Mat> shared = all();
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_TRUE(equal(shared[i], expected[i])) << i;
}
