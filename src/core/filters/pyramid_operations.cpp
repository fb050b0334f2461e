#include <opencv2/imgproc.hpp>

#include "operation_table.hpp"
#include "pyramid_filter.hpp"

namespace robot_vision
{
namespace
{

/// The Gaussian pyramid of an image in floating point, at most so many levels high.
std::vector<cv::Mat> gaussianPyramid(const cv::Mat& image, int levels)
{
  std::vector<cv::Mat> pyramid(1);
  image.convertTo(pyramid[0], CV_32F);
  while (static_cast<int>(pyramid.size()) <= levels && std::min(pyramid.back().rows, pyramid.back().cols) > 1)
  {
    cv::Mat smaller;
    cv::pyrDown(pyramid.back(), smaller);
    pyramid.push_back(smaller);
  }
  return pyramid;
}

/// What each level has that the next one lacks; the last level as it is.
std::vector<cv::Mat> laplacianPyramid(const cv::Mat& image, int levels)
{
  std::vector<cv::Mat> pyramid = gaussianPyramid(image, levels);
  for (std::size_t i = 0; i + 1 < pyramid.size(); ++i)
  {
    cv::Mat larger;
    cv::pyrUp(pyramid[i + 1], larger, pyramid[i].size());
    pyramid[i] -= larger;
  }
  return pyramid;
}

/// The left half of `left` beside the right half of `right`, joined at every level of their pyramids.
void blendHalves(const cv::Mat& left, const cv::Mat& right, int levels, cv::Mat& out)
{
  std::vector<cv::Mat> sum = laplacianPyramid(right, levels);
  const std::vector<cv::Mat> other = laplacianPyramid(left, levels);
  for (std::size_t i = 0; i < sum.size(); ++i)
  {
    const cv::Range half(0, sum[i].cols / 2);
    if (!half.empty()) other[i].colRange(half).copyTo(sum[i].colRange(half));
  }
  for (std::size_t i = sum.size() - 1; i > 0; --i)
  {
    cv::Mat larger;
    cv::pyrUp(sum[i], larger, sum[i - 1].size());
    sum[i - 1] += larger;
  }
  sum[0].convertTo(out, left.type());
}

/// Applies a function to its own result so many times, never in place.
template <class Function>
void repeat(int times, cv::Mat& image, const Function& function)
{
  for (int i = 0; i < times; ++i)
  {
    cv::Mat result;
    function(image, result);
    image = result;
  }
}

}  // namespace

std::vector<Operation> pyramidOperations()
{
  return {
      {"pyramid_down",
       "The image blurred and halved, level by level: cv::pyrDown.",
       kAllPixels,
       "",
       {{"levels", 1, Range{1, 6}, "", "how often"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             out = in.image;
             repeat(v.integer("levels"), out, pyramidDown);
           })},
      {"pyramid_up",
       "The image doubled and blurred: cv::pyrUp.",
       kAllPixels,
       "",
       {{"levels", 1, Range{1, 3}, "", "how often"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             requireResultSize(in.image.size(), 1 << v.integer("levels"));
             out = in.image;
             repeat(v.integer("levels"), out, [](const cv::Mat& level, cv::Mat& next) { cv::pyrUp(level, next); });
           })},
      {"laplacian_pyramid",
       "What one level of the pyramid has and the next one lacks, around middle gray: cv::pyrDown, cv::pyrUp.",
       kGrayOrColor,
       "",
       {{"level", 0, Range{0, 6}, "", "0 is the image's own size"}},
       eachTime(
           [](const OperationValues& v, const OperationInput& in, cv::Mat& out)
           {
             const std::vector<cv::Mat> pyramid = laplacianPyramid(in.image, v.integer("level") + 1);
             const std::size_t level = std::min(static_cast<std::size_t>(v.integer("level")), pyramid.size() - 1);
             pyramid[level].convertTo(out, in.image.type(), 1.0, 128.0);
           })},
      {"pyramid_blend",
       "The left half of the other image and the right half of this one, joined at every level of their pyramids.",
       kEightBits,
       "",
       {{"levels", 5, Range{1, 8}, "", "of the pyramid"}},
       eachTime([](const OperationValues& v, const OperationInput& in, cv::Mat& out)
                { blendHalves(in.second, in.image, v.integer("levels"), out); }),
       "input"},
  };
}

}  // namespace robot_vision
