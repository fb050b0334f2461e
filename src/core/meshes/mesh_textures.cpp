#include "mesh_textures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

// Numbers that are larger, or none, come of triangles that are seen from the side: rounding is all that they have.
constexpr float kMaxPosition = 1e6F;

/// The texel at which interpolation begins, the one after it, and how far it is on the way from one to the other.
struct Between
{
  int first;
  int second;
  float part;
};

/// std::floor, which without SSE4.1 is a call, of a number of moderate size.
int floorOf(float number)
{
  const int truncated = static_cast<int>(number);
  return truncated - (number < static_cast<float>(truncated) ? 1 : 0);
}

Between between(float position, int count)
{
  if (!(std::abs(position) < kMaxPosition)) position = 0.0F;
  const float share = position - static_cast<float>(floorOf(position));
  const float texels = share * static_cast<float>(count) - 0.5F;  // from the center of the first one
  const int first = floorOf(texels);
  return {first < 0 ? count - 1 : std::min(first, count - 1), first + 1 < count ? first + 1 : 0,
          texels - static_cast<float>(first)};
}

}  // namespace

MeshTexture::MeshTexture(const cv::Mat& image) : levels_{image.clone()}
{
  while (std::max(levels_.back().cols, levels_.back().rows) > 1)
  {
    const cv::Size half(std::max(levels_.back().cols / 2, 1), std::max(levels_.back().rows / 2, 1));
    cv::Mat smaller;
    cv::resize(levels_.back(), smaller, half, 0, 0, cv::INTER_AREA);
    levels_.push_back(smaller);
  }
}

cv::Vec3f MeshTexture::color(float u, float v, float squared_texels) const
{
  const float most = 2.0F;  // squared: from a level to the next it is a quarter
  std::size_t level = 0;
  for (float squared = squared_texels; squared > most && level + 1 < levels_.size(); squared /= 4.0F)
    ++level;
  const cv::Mat& image = levels_[level];
  const Between x = between(u, image.cols), y = between(v, image.rows);
  const cv::Vec3b* upper = image.ptr<cv::Vec3b>(y.first);
  const cv::Vec3b* lower = image.ptr<cv::Vec3b>(y.second);
  cv::Vec3f color;
  for (int i = 0; i < 3; ++i)
  {
    const float above = upper[x.first][i] + x.part * static_cast<float>(upper[x.second][i] - upper[x.first][i]);
    const float below = lower[x.first][i] + x.part * static_cast<float>(lower[x.second][i] - lower[x.first][i]);
    color[i] = above + y.part * (below - above);
  }
  return color;
}

}  // namespace robot_vision
