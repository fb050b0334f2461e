#include "similar_neighbors.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace robot_vision
{
namespace
{

/// Pixels in a union-find forest whose roots are the first pixels of their regions.
class PixelForest
{
public:
  explicit PixelForest(int pixels) : parents_(pixels) { std::iota(parents_.begin(), parents_.end(), 0); }

  int root(int pixel)
  {
    while (parents_[pixel] != pixel)
      pixel = parents_[pixel] = parents_[parents_[pixel]];
    return pixel;
  }

  void join(int a, int b)
  {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<int> parents_;
};

bool isSimilar(const cv::Vec3b& a, const cv::Vec3b& b, int tolerance)
{
  return std::abs(a[0] - b[0]) <= tolerance && std::abs(a[1] - b[1]) <= tolerance && std::abs(a[2] - b[2]) <= tolerance;
}

}  // namespace

cv::Mat similarNeighbors(const cv::Mat& bgr, double tolerance)
{
  const int levels = static_cast<int>(tolerance);  // differences are whole numbers
  const int width = bgr.cols;
  PixelForest forest(static_cast<int>(bgr.total()));
  for (int y = 0; y < bgr.rows; ++y)
  {
    const auto* row = bgr.ptr<cv::Vec3b>(y);
    const auto* above = bgr.ptr<cv::Vec3b>(std::max(y - 1, 0));
    for (int x = 0; x < width; ++x)
    {
      const int pixel = y * width + x;
      if (x > 0 && isSimilar(row[x], row[x - 1], levels)) forest.join(pixel, pixel - 1);
      if (y > 0 && isSimilar(row[x], above[x], levels)) forest.join(pixel, pixel - width);
    }
  }
  cv::Mat_<int> labels(bgr.size());
  int count = 0;
  for (int pixel = 0; pixel < static_cast<int>(labels.total()); ++pixel)
  {
    const int root = forest.root(pixel);
    labels(pixel / width, pixel % width) = root == pixel ? ++count : labels(root / width, root % width);
  }
  return labels;
}

}  // namespace robot_vision
