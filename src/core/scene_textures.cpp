#include "scene_textures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace robot_vision::scene
{

namespace
{

std::uint64_t pack(const cv::Vec4b& colour)
{
  std::uint64_t texel = 0;
  for (int lane = 0; lane < 4; ++lane)
    texel |= static_cast<std::uint64_t>(colour[lane]) << (16 * lane);
  return texel;
}

cv::Mat withAlpha(const cv::Mat& picture)
{
  if (picture.type() == CV_8UC4) return picture;
  cv::Mat bgra;
  cv::cvtColor(picture, bgra, cv::COLOR_BGR2BGRA);
  return bgra;
}

TextureLevel makeLevel(const cv::Mat& bgra)
{
  TextureLevel level;
  level.width = bgra.cols;
  level.height = bgra.rows;
  level.texels.reserve(static_cast<std::size_t>(bgra.cols + 2) * (bgra.rows + 2));
  for (int y = -1; y <= bgra.rows; ++y)
  {
    for (int x = -1; x <= bgra.cols; ++x)
    {
      const int inside_x = std::clamp(x, 0, bgra.cols - 1), inside_y = std::clamp(y, 0, bgra.rows - 1);
      cv::Vec4b colour = bgra.at<cv::Vec4b>(inside_y, inside_x);
      if (x != inside_x || y != inside_y) colour[3] = 0;
      level.texels.push_back(pack(colour));
    }
  }
  return level;
}

}  // namespace

Texture cellTexture(const cv::Mat& cells_bgr)
{
  // In small steps, so that a texel is never much larger than a pixel.
  const int most_texels = 512;  // along the longer side, for the sake of memory
  const int cells = std::max(cells_bgr.cols, cells_bgr.rows);
  Texture texture;
  for (const int texels_per_cell : {32, 28, 24, 20, 16, 14, 12, 10, 8, 7, 6, 5, 4, 3, 2, 1})
  {
    if (texels_per_cell * cells > most_texels) continue;
    cv::Mat scaled;
    cv::resize(cells_bgr, scaled, cells_bgr.size() * texels_per_cell, 0, 0, cv::INTER_NEAREST);
    texture.push_back(makeLevel(withAlpha(scaled)));
  }
  return texture;
}

Texture pictureTexture(const cv::Mat& picture)
{
  const cv::Mat finest = withAlpha(picture);
  Texture texture;
  for (double scale = 1.0;; scale /= std::sqrt(2.0))
  {
    const cv::Size size(std::max(1, cvRound(finest.cols * scale)), std::max(1, cvRound(finest.rows * scale)));
    cv::Mat scaled;
    cv::resize(finest, scaled, size, 0, 0, cv::INTER_AREA);
    texture.push_back(makeLevel(scaled));
    if (std::max(size.width, size.height) <= 4) return texture;
  }
}

}  // namespace robot_vision::scene
